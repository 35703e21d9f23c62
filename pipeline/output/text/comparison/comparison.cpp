#include "pipeline/output/text/comparison/comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "mesh/text/words.h"
#include "pipeline/output/text/errors.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string share(const json& error) {
    if (!error["relative"].is_number()) return "an unknown share of the displacement";
    return mesh::share_of(error["relative"].get<double>(), "the displacement");
}

/// Is what the body in finite elements leaves noise, and the nuisances of contacts and clamps?
bool is_explained_by_reference(const json& compare) {
    constexpr double adequate = 1.1;  // sigmas, as a diagnosis takes it
    const json reference = compare.value("reference", json());
    if (!reference.is_object() || !reference["whitened_rms"].is_number()) return false;
    return reference["whitened_rms"].get<double>() <= adequate;
}

std::string noise_words(const json& compare) {
    const json& error = compare["error"];
    if (!error["noise_mm"].is_number()) return {};
    const json budget = compare.value("budget", json());
    std::string left = "the model lacks something";
    if (compare["adequate"].get<bool>()) {
        left = "what is left is noise";
    } else if (is_explained_by_reference(compare)) {
        left = "what is left beyond it is the coarseness of the skeleton and unknown details of contacts and clamps";
    } else if (!budget.is_object()) {
        left =
            "the rest is missing physics or discretisation error of the skeleton, which these data cannot "
            "distinguish";
    } else if (budget.is_object() && budget["missing_physics"].get<double>() < budget["reduction"].get<double>()) {
        left = "what is left beyond it is mostly the coarseness of the skeleton";
    }
    return fmt::format(" The measurement noise is {:.3g} mm rms: {}.", error["noise_mm"].get<double>(), left);
}

/// Where a model that was fitted well fails on what it has not seen.
std::string held_out_words(const json& compare) {
    if (!compare.contains("held_out") || !compare["held_out"].contains("worst_probes")) return {};
    constexpr double far = 2;  // times the error on the probes that were fitted
    const json fitted = compare["fitted"]["relative"], unseen = compare["held_out"]["relative"];
    if (!fitted.is_number() || !unseen.is_number() || unseen.get<double>() < far * fitted.get<double>()) return {};
    std::string text;
    for (const json& probe : compare["held_out"]["worst_probes"]) {
        text += fmt::format("{}probe {} at {} by {}", text.empty() ? " Worst of these: " : ", ",
                            probe["probe"].get<int>(), place(probe["at"]), percent(probe["relative"].get<double>()));
        if (probe["from_support_mm"].is_number())
            text += fmt::format(", {:.3g} mm from what is held", probe["from_support_mm"].get<double>());
    }
    return text.empty() ? text : text + ". Probes next to these would make the links there observable.";
}

std::string reference_words(const json& compare) {
    const json baseline = compare.value("baseline", json()), reference = compare.value("reference", json());
    if (!baseline.is_object() || !reference.is_object()) return {};
    const std::string rms =
        reads_positions(compare) || reference.contains("reactions_rms_n") ? rms_in_words(reference) : "";
    const std::string error = rms.empty() ? "" : rms + " rms: ";
    return fmt::format(" The finite-element model ({}, {}) is off by {}{}.",
                       law_in_words(baseline["law"].get<std::string>()), material_in_words(baseline), error,
                       in_sigmas(reference["whitened_rms"]));
}

/// How the error varies with the load, where it is more than finite elements leave.
std::string load_words(const json& compare) {
    if (!compare.contains("load_exponent") || compare["adequate"].get<bool>() || is_explained_by_reference(compare))
        return {};
    const json& exponent = compare["load_exponent"];
    return fmt::format(" The error varies with the load to the power {}: {}.",
                       mesh::with_sd(exponent["value"].get<double>(), exponent["sd"].get<double>()),
                       exponent["words"].get<std::string>());
}

std::string budget_words(const json& compare) {
    const json budget = compare.value("budget", json());
    if (!budget.is_object() || !reads_positions(compare)) return {};
    constexpr double all = 0.9995;  // shown as 100.0 %
    const double noise = budget["noise"].get<double>();
    if (noise >= all) return " The noise accounts for all of the real-time model's mean square error.";
    return fmt::format(
        " Of the real-time model's mean square error, {} is noise, {} the coarseness of the skeleton, {} unexplained.",
        percent(noise), percent(budget["reduction"].get<double>()), percent(budget["missing_physics"].get<double>()));
}

/// The regions that noise does not explain, worst first.
std::string region_words(const json& compare) {
    constexpr std::size_t most = 3;  // that a sentence has room for
    std::vector<json> strange;
    for (const json& region : compare.value("regions", json::array())) {
        if (region["strange"].get<bool>()) strange.push_back(region);
    }
    if (strange.empty() || compare["regions"].size() < 2) return {};
    std::ranges::stable_sort(strange, std::greater{}, [](const json& r) { return r["whitened_rms"].get<double>(); });
    std::string places;
    for (std::size_t i = 0; i < std::min(most, strange.size()); ++i) {
        places += fmt::format("{}{} ({:.3g} sigma)", i > 0 ? ", " : "", place(strange[i]["at"]),
                              strange[i]["whitened_rms"].get<double>());
    }
    return fmt::format(" It fails in {} of {} regions, worst around {}.", strange.size(), compare["regions"].size(),
                       places);
}

/// How far the model is off, in positions and in the forces of tools, as far as these were measured.
std::string error_words(const json& compare, const std::string& model) {
    const json& error = compare["error"];
    std::string text;
    if (reads_positions(compare))
        text = fmt::format("{} is off by {:.3g} mm rms, {}, and by {:.3g} mm at most.", model,
                           error["rms_mm"].get<double>(), share(error), error["max_mm"].get<double>());
    if (error.contains("reactions")) {
        const json& forces = error["reactions"];
        const std::string part = forces["relative"].is_number()
                                     ? mesh::share_of(forces["relative"].get<double>(), "the measured forces")
                                     : "where none was measured";
        text +=
            fmt::format("{}The reactions of tools are off by {:.3g} N rms, {}, and by {:.3g} N at most.",
                        text.empty() ? "" : " ", forces["rms_n"].get<double>(), part, forces["max_n"].get<double>());
    }
    return text;
}

}  // namespace

bool reads_positions(const json& compare) {
    return !compare["error"].contains("reactions") || !compare.value("probes", json::array()).empty();
}

std::string compare_in_words(const json& compare, const std::string& model) {
    const json& error = compare["error"];
    std::string text = error_words(compare, model);
    if (reads_positions(compare)) {
        text += if_it_explains_nothing(error["relative"]);
    } else if (error["reactions"]["relative"].is_number() && error["reactions"]["relative"].get<double>() >= 1) {
        text += " That is more than was measured: this model does not predict forces of tools.";
    }
    if (compare.contains("held_out")) {
        text += fmt::format(" On the probes that were fitted it is off by {}, on those held out by {}.",
                            share(compare["fitted"]), share(compare["held_out"]));
    }
    text += held_out_words(compare) + noise_words(compare);
    if (compare.contains("not_borne")) {
        text += fmt::format(" The model has no equilibrium under the full load of probes {}: a reduced load was used.",
                            fmt::join(compare["not_borne"].get<std::vector<int>>(), ", "));
    }
    return text + load_words(compare) + reference_words(compare) + budget_words(compare) + region_words(compare);
}

}  // namespace palpate::pipeline
