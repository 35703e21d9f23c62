#include "mesh/errors.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/run/batch/batch.h"

namespace palpate::pipeline::commands {

Outcome run_batch(const BatchOptions& options, const Common& common) {
    const Workers workers = parse_workers(options.workers);
    const Batch batch{.items = batch_items(options.inputs),
                      .output = options.output,
                      .flags = options.overrides.flags(),
                      .threads = common.threads};
    work_off(batch, workers, Console::progress());
    Outcome outcome;
    outcome.json = batch_json(batch);
    outcome.text = batch_table(outcome.json);
    for (const nlohmann::json& row : outcome.json["runs"]) {
        if (outcome.code == done && row.contains("expectations_not_met")) outcome.code = not_met;
        if (row.contains("error")) outcome.code = numerical_failure;
    }
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_run(CLI::App& app) {
    auto* sub = subcommand(
        app, "run", "The whole pipeline: mesh, skeleton, identification, comparison, diagnosis, improvement, report.",
        "  palpate run liver.stl --longest 200\n"
        "  palpate run my-measurements/ -o result\n"
        "  palpate run case.yaml\n"
        "  palpate run livers/*.stl -o runs --workers local:4     many, four at a time, by Snakemake\n"
        "  palpate run sets/* -o runs --workers slurm:partition=short,memory=8\n",
        [this] {
            run.overrides.seed = common.seed;
            if (!batch.workers.empty()) {
                batch.output = run.output.empty() ? std::filesystem::path("runs") : run.output;
                batch.overrides = run.overrides;
                return commands::run_batch(batch, common);
            }
            if (batch.inputs.size() > 1)
                throw InvalidInput("several inputs are several runs: say who works them off, as in --workers local:2");
            run.input = batch.inputs.front();
            if (run.output.empty()) {
                run.output =
                    std::filesystem::path(std::filesystem::weakly_canonical(run.input).stem().string() + "-run");
            }
            return commands::run(run, common);
        });
    sub->add_option("INPUT", batch.inputs,
                    "A case.yaml, a measurement set (folder or set.yaml), or a mesh; several with\n--workers")
        ->required();
    sub->add_option("-o,--output", run.output,
                    "The run folder, <input>-run by default; with --workers the folder of\nthe runs");
    sub->add_option(
           "--workers", batch.workers,
           "Run each input by itself, with Snakemake: local:N, slurm, slurm:partition=NAME,account=NAME,jobs=N,\n"
           "memory=GB,minutes=N, or snakemake:PROFILE. What is done stays done, what fails is resumed")
        ->type_name("WORKERS")
        ->group("Many runs");
    for (const char* group : {"Body", "Skeleton", "Sphere curve", "Probing", "Identification", "Diagnosis"})
        add_flags_of(sub, run.overrides, group);
}

}  // namespace palpate::pipeline
