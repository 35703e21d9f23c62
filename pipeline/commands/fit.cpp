#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "pipeline/commands/bodies.h"
#include "pipeline/results/compare_words.h"
#include "pipeline/results/identification.h"
#include "pipeline/results/reference_comparison.h"
#include "pipeline/results/results.h"
#include "pipeline/results/series.h"

// What works on a model and measurements: identify, compare.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// What the body in finite elements says beside the skeleton; where there is none, why.
void compare_reference(nlohmann::json& result, const CompareOptions& options, const Common& common,
                       const ModelAndSet& given, const identify::Comparison& comparison) {
    if (options.no_reference) {
        add_no_reference(result, "it was not asked for");
        return;
    }
    try {
        const auto body = reference_of(given.set, options.say.on_defaults().edge_length);
        identify::DiagnoseOptions how = diagnose_options(given.model, common);
        how.screen = false;
        add_reference(result, *body, identify::diagnose(*body, given.set, how, Console::progress()), given.set,
                      comparison);
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

Outcome identify(const IdentifyCommandOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("identified") : options.output;
    refuse_to_overwrite(output, common.force);
    const auto [model, set] = read_model_and_set(options.model, options.set);

    identify::IdentifyOptions how = options.say.on_defaults().identify;
    how.seed = common.seed.value_or(how.seed);
    how.threads = common.threads;
    identify::IdentifyResult found = identify::identify(model, set, how, Console::progress());
    found.damping = damping_of(found.model, set, how.seed, common);
    write_identification(output, found);

    Outcome outcome;
    outcome.json = summary_json(found);
    outcome.json["model"] = (output / "model.json").string();
    const std::string fitted = (output / "model.json").string();
    outcome.text = fmt::format("{}:\n{}Next: palpate compare {} {}\n", fitted, identification_in_words(found), fitted,
                               options.set.string());
    return outcome;
}

Outcome compare(const CompareOptions& options, const Common& common) {
    const ModelAndSet given = read_model_and_set(options.model, options.set);
    const skeleton::Model& model = given.model;
    const identify::MeasurementSet set = understood(given.set, model.effects);
    const identify::Comparison comparison = identify::compare(model, set, common.threads);

    Outcome outcome;
    outcome.json = to_json(comparison, set);
    compare_reference(outcome.json, options, common, given, comparison);
    outcome.text = compare_in_words(outcome.json) + "\n";
    if (!options.output.empty()) {
        refuse_to_overwrite(options.output, common.force);
        write_played_series(options.output, model, set, comparison);
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
