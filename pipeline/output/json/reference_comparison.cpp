#include "pipeline/output/json/reference_comparison.h"

#include <algorithm>
#include <cmath>

#include "identify/comparison/error_budget.h"
#include "identify/diagnosis/statistics/fit_errors.h"
#include "pipeline/output/json/json_values.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json to_json(const identify::ErrorBudget& budget) {
    return {{"noise", budget.noise}, {"reduction", budget.reduction}, {"missing_physics", budget.missing_physics}};
}

/// Adds how strange the reference body finds each marker to what is told of it already.
void add_strangeness(json& markers, const identify::MeasurementSet& set, const identify::ErrorLocations& where) {
    for (json& entry : markers) {
        for (std::size_t m = 0; m < set.markers.size(); ++m) {
            if (entry["marker"] != set.markers[m].id) continue;
            entry["whitened_rms"] = known(where.markers[m].whitened_rms);
            entry["p_value"] = known(where.markers[m].p_value);
            entry["strange"] = where.markers[m].strange;
        }
    }
}

json regions_json(const identify::MeasurementSet& set, const identify::ErrorLocations& where) {
    json regions = json::array();
    for (const identify::PlaceError& region : where.regions) {
        json markers = json::array();
        for (const int m : region.markers) markers.push_back(set.markers[m].id);
        regions.push_back({{"at", numbers(region.at)},
                           {"markers", markers},
                           {"rms_mm", known(region.rms_mm)},
                           {"whitened_rms", known(region.whitened_rms)},
                           {"p_value", known(region.p_value)},
                           {"strange", region.strange}});
    }
    return regions;
}

}  // namespace

json baseline_json(const identify::BodyModel& model, const identify::Problem& problem, const identify::Refit& fit) {
    const identify::ModelSetting setting = fit.explanation.setting();
    json result = {{"law", model.laws()[setting.law]},
                   {"young_mpa", model.young(setting)},
                   {"poisson", nullptr},
                   {"poisson_sd", nullptr},
                   {"unsure_mm", identify::errors_of(problem, fit).nuisance_sd},
                   {"discretisation_mm", nullptr}};
    if (problem.discretisation.size() > 0) {
        result["discretisation_mm"] =
            std::sqrt(problem.discretisation.squaredNorm() / static_cast<double>(problem.rows()));
    }
    const auto& parameters = model.parameters();
    const auto nu = std::ranges::find(parameters, "compressibility", &identify::StiffnessParameter::name);
    if (nu != parameters.end()) {
        // nu = (1 - e^theta) / 2
        const auto j = nu - parameters.begin();
        const double ratio = std::exp(fit.explanation.theta[j]);
        result["poisson"] = (1 - ratio) / 2;
        result["poisson_sd"] = ratio / 2 * std::sqrt(fit.covariance(j, j));
    }
    return result;
}

void add_reference(json& compare, const identify::BodyModel& reference, const identify::Diagnosis& diagnosis,
                   const identify::MeasurementSet& set, const identify::Comparison& comparison) {
    const identify::Problem& problem = diagnosis.problem;
    const identify::FitErrors errors = identify::errors_of(problem, diagnosis.baseline);
    compare["reference"] = {{"rms_mm", errors.rms},
                            {"max_mm", errors.max},
                            {"relative", known(errors.relative)},
                            {"whitened_rms", errors.whitened_rms}};
    compare["baseline"] = baseline_json(reference, problem, diagnosis.baseline);
    const double noise = problem.rms_sigma();
    compare["budget"] = to_json(identify::split_error_budget(identify::mean_square_error(problem, set, comparison),
                                                             noise * noise, errors.left));
    add_strangeness(compare["markers"], set, errors.where);
    compare["regions"] = regions_json(set, errors.where);
}

void add_no_reference(json& compare, const std::string& why_none) {
    for (const char* key : {"reference", "baseline", "budget"}) compare[key] = nullptr;
    compare["why_no_reference"] = why_none;
}

void add_own_reference(json& compare, double noise) {
    compare["reference"] = {{"rms_mm", 0.0}, {"max_mm", 0.0}, {"relative", 0.0}, {"whitened_rms", nullptr}};
    compare["baseline"] = nullptr;
    const double rms = compare["error"]["rms_mm"].get<double>();
    compare["budget"] = to_json(identify::split_error_budget(rms * rms, noise * noise, noise * noise));
}

}  // namespace palpate::pipeline
