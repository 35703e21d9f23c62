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

/// Adds how strange the reference body finds each marker to what is reported of it already.
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

json to_json(const identify::MaterialEstimate& material) {
    json result = {{"law", material.law},
                   {"young_mpa", known(material.young)},
                   {"young_sd_mpa", known(material.young_sd)},
                   {"poisson", known(material.poisson)},
                   {"poisson_sd", known(material.poisson_sd)},
                   {"poisson_declared", material.poisson_is_declared}};
    for (const identify::RegionEstimate& region : material.regions)
        result["regions"].push_back(
            {{"name", region.name}, {"young_mpa", known(region.young)}, {"sd", known(region.young_sd)}});
    return result;
}

json baseline_json(const identify::BodyModel& model, const identify::Problem& problem, const identify::Refit& fit) {
    json result = to_json(identify::material_of(model, fit));
    result["unsure_mm"] = identify::errors_of(problem, fit).nuisance_sd;
    result["discretisation_mm"] = nullptr;
    if (problem.discretisation.size() > 0) {
        result["discretisation_mm"] = problem.rms_mm(problem.discretisation);
    }
    return result;
}

void add_reference(json& compare, const identify::BodyModel& reference, const identify::Problem& problem,
                   const identify::Refit& fit, const identify::MeasurementSet& set,
                   const identify::Comparison& comparison) {
    const identify::FitErrors errors = identify::errors_of(problem, fit);
    compare["reference"] = {{"rms_mm", errors.rms},
                            {"max_mm", errors.max},
                            {"relative", known(errors.relative)},
                            {"whitened_rms", errors.whitened_rms}};
    compare["baseline"] = baseline_json(reference, problem, fit);
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
