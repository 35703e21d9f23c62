#include <fmt/format.h>

#include "identify/comparison/compare.h"
#include "identify/diagnosis/diagnose.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/comparison/worst.h"
#include "pipeline/output/vtk/series.h"
#include "pipeline/run/inputs/model_and_set.h"

namespace palpate::pipeline::commands {
namespace {

/// What the body in finite elements says beside the skeleton; where there is none, why.
void compare_reference(nlohmann::json& result, const CompareOptions& options, const Common& common,
                       const ModelAndSet& given, const identify::Comparison& comparison) {
    if (options.no_reference) {
        add_no_reference(result, "it was not asked for");
        return;
    }
    try {
        const auto body = reference_of(given.set, options.overrides.on_defaults());
        identify::DiagnoseOptions how = diagnose_options({}, given.set.density.has_value(), given.model, common);
        how.screen = false;
        const identify::Diagnosis found = identify::diagnose(*body, given.set, how, Console::progress());
        add_reference(result, *body, found.problem, found.baseline, given.set, comparison);
        warn_of_modulus(result, given.set);
    } catch (const InvalidInput& e) {
        Console::warning(e.what());
        add_no_reference(result, e.what());
    } catch (const SolverFailure& e) {
        Console::warning(e.what());
        add_no_reference(result, e.what());
    }
}

}  // namespace

Compared compare(const ModelAndSet& given, const CompareOptions& options, const Common& common) {
    Compared result{.set = without_measurement_faults(given.set, given.model.effects), .comparison = {}, .json = {}};
    result.comparison = identify::compare(given.model, result.set, common.threads);
    result.json = to_json(result.comparison, result.set);
    compare_reference(result.json, options, common, given, result.comparison);
    return result;
}

Outcome compare(const CompareOptions& options, const Common& common) {
    const ModelAndSet given = read_model_and_set(options.model, options.set);
    const auto [set, comparison, json] = compare(given, options, common);

    Outcome outcome;
    outcome.json = json;
    outcome.text = compare_in_words(outcome.json) + "\n" + worst_table(outcome.json);
    if (!options.output.empty()) {
        refuse_to_overwrite(options.output, common.force);
        write_played_series(options.output, given.model, set, comparison);
        mesh::write_text(options.output / "compare.json", outcome.json.dump(2) + "\n");
        outcome.text += fmt::format("Written: {}\n", options.output.string());
    }
    if (!comparison.adequate) {
        outcome.text += fmt::format("Next: palpate diagnose {} {}\n", options.model.string(), options.set.string());
    }
    if (options.tolerance && comparison.rms > *options.tolerance) {
        outcome.code = not_met;
        Console::error(fmt::format("the error of {:.4g} mm rms is above the tolerance of {:g} mm", comparison.rms,
                                   *options.tolerance));
    }
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_compare(CLI::App& app) {
    auto* sub = subcommand(
        app, "compare", "Model against measurements: how wrong, where, under which probe.",
        "  palpate compare model.json set/\n  palpate compare model.json set/ --tolerance 0.5 && echo good enough\n"
        "  palpate compare model.json set/ --no-reference     # the skeleton alone: fast\n",
        [this] { return commands::compare(compare, common); });
    sub->add_option("MODEL", compare.model, "model.json")->required();
    sub->add_option("SET", compare.set, "The measurements")->required();
    sub->add_option("-o,--output", compare.output, "Folder for compare.json and the .vtp series");
    sub->add_option("--tolerance", compare.tolerance, "Exit code 5 where the rms error is larger [mm]")
        ->check(CLI::NonNegativeNumber);
    sub->add_flag("--no-reference", compare.no_reference,
                  "Leave the finite-element model out: fast, but without an error budget");
    add_flag(sub, compare.overrides, "volume.edge_length");
}

}  // namespace palpate::pipeline
