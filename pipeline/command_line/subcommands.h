#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/import_options.h"

namespace palpate::pipeline {

/// All commands with their options, as CLI11 fills them in.
struct Subcommands {
    commands::Common common;
    std::function<commands::Outcome()> command;  // that was asked for

    commands::RunOptions run;
    commands::BatchOptions batch;  // of several
    commands::CheckOptions check;
    commands::ImportCommandOptions importing;
    commands::MeshOptions mesh;
    commands::SkeletonOptions skeleton;
    QualityOptions quality;     // of it,
    bool with_quality = false;  // where it is asked for
    commands::ProbeCommandOptions probe;
    commands::IdentifyCommandOptions identify;
    commands::CompareOptions compare;
    commands::DiagnoseCommandOptions diagnose;
    commands::ImproveCommandOptions improve;
    commands::EffectsOptions effects;
    commands::SimulateOptions simulate;
    commands::ExportOptions exports;
    commands::ReportOptions report;
    commands::PoolOptions pool;
    commands::PlayOptions play;
    commands::NewOptions new_case;
    commands::InfoOptions info;

    // Each beside what the command does, in pipeline/cli/<command>.cpp or the folder of that name.
    void add_run(CLI::App& app);
    void add_check(CLI::App& app);
    void add_import(CLI::App& app);
    void add_mesh(CLI::App& app);
    void add_skeleton(CLI::App& app);
    void add_probe(CLI::App& app);
    void add_identify(CLI::App& app);
    void add_compare(CLI::App& app);
    void add_diagnose(CLI::App& app);
    void add_improve(CLI::App& app);
    void add_simulate(CLI::App& app);
    void add_export(CLI::App& app);
    void add_play(CLI::App& app);
    void add_pool(CLI::App& app);
    void add_report(CLI::App& app);

    // Around the work, in pipeline/cli/shell.
    void add_new(CLI::App& app);
    void add_info(CLI::App& app);
    void add_effects(CLI::App& app);
    void add_completion(CLI::App& app);
    void add_man(CLI::App& app);

    /// A command whose help begins with examples.
    CLI::App* subcommand(CLI::App& app, const std::string& name, const std::string& what, const std::string& examples,
                         const std::function<commands::Outcome()>& action);
};

}  // namespace palpate::pipeline
