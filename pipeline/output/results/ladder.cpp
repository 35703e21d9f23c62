#include "pipeline/output/results/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/particles.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/damping.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/json_values.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/text/errors.h"
#include "pipeline/output/text/words.h"
#include "pipeline/output/vtk/ladder_series.h"
#include "pipeline/output/vtk/series.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json errors_json(const identify::StepError& error) {
    json result = {{"rms_mm", known(error.rms_mm)},
                   {"held_out_rms_mm", known(error.held_out_rms_mm)},
                   {"relative", known(error.relative)}};
    if (!std::isnan(error.rms_n)) {
        result["reactions_rms_n"] = error.rms_n;
        result["held_out_reactions_rms_n"] = known(error.held_out_rms_n);
    }
    return result;
}

json to_json(const identify::LadderStep& step) {
    json result = errors_json(step.skeleton);
    result["effects"] = json::array();
    for (const skeleton::EffectRecord& effect : step.effects) result["effects"].push_back(effect.name);
    result["log_evidence"] = known(step.log_evidence);
    result["predicted_rms_mm"] = known(step.predicted_rms_mm);
    result["reference"] = nullptr;
    if (step.reference) {
        result["reference"] = pipeline::to_json(step.material);
        result["reference"].update(errors_json(*step.reference));
        result["reference"]["whitened_rms"] = known(step.reference->whitened_rms);
        result["reference"]["held_out_whitened_rms"] = known(step.reference->held_out_whitened_rms);
    }
    return result;
}

std::string error_in_words(const json& error) {
    const std::string text = rms_in_words(error) + " rms", held_out = held_out_rms_in_words(error);
    return held_out.empty() ? text : text + fmt::format(" ({} on held-out probes)", held_out);
}

std::string step_in_words(const json& step) {
    const auto effects = step["effects"].get<std::vector<std::string>>();
    std::string text = effects.empty() ? "Nothing added: " : "With " + listed(effects) + ": ";
    if (step["reference"].is_object()) text += "real-time model ";
    text += error_in_words(step);
    if (step["reference"].is_object()) {
        text += "; finite-element model " + error_in_words(step["reference"]);
        if (step["reference"].contains("young_mpa")) text += ", " + material_in_words(step["reference"]);
    }
    return text + ".";
}

/// How much farther off than the finite elements the skeleton is, of which a user is warned.
std::string coarseness_in_words(const json& step) {
    constexpr double much = 2;  // times the finite elements' error: most of the skeleton's is its own
    const char* rms = keys_of(step).fitted;
    if (step[rms].get<double>() < much * step["reference"][rms].get<double>()) return {};
    std::string share;
    if (step["relative"].is_number())
        share = fmt::format(" ({:.2g} % of the {})", 100 * step["relative"].get<double>(),
                            keys_of(step).unit == std::string_view("mm") ? "displacement" : "force");
    return fmt::format(" The real-time model is off by {} rms{}: more spheres (--spheres) bring it closer.",
                       rms_in_words(step), share);
}

/// What a model leaves in which nothing more is found. The verdict allows for what is unknown about contacts, clamps
/// and tools; the model's own error does not.
std::string adequate_in_words(const json& ladder) {
    const json& last = ladder["steps"].back();
    if (last["reference"].is_object())
        return "The residual of the finite-element model is noise." + coarseness_in_words(last);
    const json noise = ladder.value("noise_mm", json());
    constexpr double as_noise = 1.1;  // as a diagnosis takes it
    if (!noise.is_number() || last["rms_mm"].get<double>() <= as_noise * noise.get<double>())
        return "What is left is noise.";
    return fmt::format(
        "No further effect is found. The model is off by more than the noise of {:.3g} mm, by no more than what is "
        "unknown about contacts, clamps and tools explains.",
        noise.get<double>());
}

/// The verdict is on the body in finite elements, where there is one: a skeleton may be coarse besides.
std::string verdict_in_words(const json& ladder, const std::vector<std::string>& not_added) {
    const auto verdict = ladder["verdict"].get<std::string>();
    if (verdict == "missing-effect" && !not_added.empty())
        return fmt::format("The model still lacks {}; a skeleton of more spheres (--spheres) may carry it.",
                           listed(not_added));
    if (verdict == "adequate") return adequate_in_words(ladder);
    if (verdict == "unexplained") return "Something is still missing that the catalogue does not hold.";
    if (verdict == "ambiguous") return "An effect is still missing, but these measurements cannot identify which one.";
    return "Another effect is still missing: run diagnose on the new model.";
}

}  // namespace

json to_json(const identify::Ladder& ladder) {
    json steps = json::array(), not_added = json::array();
    for (const identify::LadderStep& step : ladder.steps) steps.push_back(to_json(step));
    for (const identify::EffectNotAdded& one : ladder.not_added)
        not_added.push_back({{"effect", one.effect}, {"why", one.why}});
    return {{"format", "palpate-ladder/1"},
            {"steps", steps},
            {"not_added", not_added},
            {"held_out_probes", ladder.held_out_probes},
            {"model", "model.json"},
            {"verdict", identify::verdict_names[static_cast<std::size_t>(ladder.verdict)]},
            {"noise_mm", known(ladder.steps.back().comparison.noise)},
            {"notes", ladder.notes}};
}

std::string ladder_in_words(const json& ladder) {
    std::string text;
    for (const json& step : ladder["steps"]) text += step_in_words(step) + "\n";
    std::vector<std::string> not_added;
    for (const json& one : ladder.value("not_added", json::array())) {
        not_added.push_back(one["effect"]);
        text += fmt::format("{} is not added: {}.\n", not_added.back(), one["why"].get<std::string>());
    }
    return text + verdict_in_words(ladder, not_added) + "\n";
}

json final_comparison(const identify::Ladder& ladder, const identify::BodyModel& body) {
    const identify::LadderStep& last = ladder.steps.back();
    json result = to_json(last.comparison, last.set);
    if (last.reference)
        add_reference(result, body, ladder.whole.problem, ladder.whole.best(), last.set, last.comparison);
    else
        add_no_reference(result, "it was judged on the skeleton");
    return result;
}

void write_ladder(const std::filesystem::path& folder, const identify::Ladder& ladder,
                  const identify::BodyModel& body) {
    const skeleton::Model& model = ladder.steps.back().model;
    write_ladder_series(folder, ladder);
    for (std::size_t i = 0; i < ladder.steps.size(); ++i) {
        const identify::LadderStep& step = ladder.steps[i];
        const std::filesystem::path of_step = folder / fmt::format("step_{}", i);
        write_played_series(of_step, step.model, step.set, step.comparison);
        skeleton::write_model(of_step / "model.json", step.validation_model);
    }
    mesh::write_text(folder / "posterior.csv", posterior_csv(ladder.identified.posterior));
    mesh::write_text(folder / "particles.csv", particles_csv(ladder.identified));
    if (ladder.identified.damping) mesh::write_text(folder / "damping.csv", damping_csv(*ladder.identified.damping));
    mesh::write_text(folder / "identify.json", summary_json(ladder.identified).dump(2) + "\n");
    skeleton::write_model_vtp(folder / "model.vtp", model);
    skeleton::write_model(folder / "model.json", model);
    mesh::write_text(folder / "compare.json", final_comparison(ladder, body).dump(2) + "\n");
    mesh::write_text(folder / "ladder.json", to_json(ladder).dump(2) + "\n");
}

}  // namespace palpate::pipeline
