#include "pipeline/output/json/diagnosis.h"

#include <cmath>
#include <optional>

#include "identify/diagnosis/statistics/fit_errors.h"
#include "pipeline/output/json/json_values.h"
#include "pipeline/output/json/reference_comparison.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json parameters_json(const identify::Candidate& candidate) {
    json result = json::object();
    for (std::size_t j = 0; j < candidate.estimate.effect.parameters.size(); ++j) {
        const skeleton::EffectParameter& p = candidate.estimate.effect.parameters[j];
        const double sd = j < candidate.estimate.sd.size() ? candidate.estimate.sd[j] : identify::missing;
        result[p.name] = {{"value", known(p.value)}, {"sd", known(sd)}, {"unit", p.unit}};
    }
    return result;
}

std::string sentence_of(const identify::Candidate& candidate) {
    const identify::EffectEstimate& estimate = candidate.estimate;
    return estimate.covariance.size() > 0 ? candidate.effect->sentence_with(estimate.effect, estimate.covariance)
                                          : candidate.effect->sentence(estimate.effect);
}

/// Errors of the forces of tools, where any was measured; of what was held out, too, where it was.
void add_forces(json& result, double rms, const std::optional<identify::HeldOut>& held_out) {
    if (std::isnan(rms)) return;
    result["reactions_rms_n"] = rms;
    if (held_out) result["held_out_reactions_rms_n"] = known(held_out->rms_n);
}

json to_json(const identify::Candidate& candidate, const identify::BodyModel& model) {
    const identify::EffectDescription& description = candidate.effect->description();
    json result = {{"effect", description.name},
                   {"kind", fem::kind_name(description.kind)},
                   {"probability", candidate.probability},
                   {"log_bayes_factor", known(candidate.log_bayes_factor)},
                   {"screened_log_bayes_factor", known(candidate.screened)},
                   {"identifiable", known(candidate.identifiable)},
                   {"predicted_rms_mm", known(candidate.predicted_rms_mm)},
                   {"rms_mm", nullptr},
                   {"whitened_rms", nullptr},
                   {"held_out_rms_mm", nullptr},
                   {"held_out_whitened_rms", nullptr},
                   {"parameters", parameters_json(candidate)},
                   {"confused_with", description.confused_with}};
    if (candidate.refit) {
        result["rms_mm"] = known(candidate.refit->rms_mm);
        add_forces(result, candidate.refit->rms_n, candidate.held_out);
        result["whitened_rms"] = known(candidate.refit->whitened_rms);
        result["law"] = model.laws()[candidate.refit->explanation.law];
    }
    if (candidate.held_out && candidate.refit) {
        result["held_out_rms_mm"] = known(candidate.held_out->rms_mm);
        result["held_out_whitened_rms"] = known(candidate.held_out->whitened_rms);
    }
    if (!candidate.objection.empty()) result["objection"] = candidate.objection;
    if (!candidate.estimate.effect.parameters.empty()) result["sentence"] = sentence_of(candidate);
    return result;
}

json to_json(const identify::NextProbe& probe) {
    json result = {{"kind", probe.kind}, {"why", probe.why}};
    if (probe.contact) {
        result["contact"] = numbers(probe.contact->point);
        result["force"] = numbers(probe.contact->force);
        result["radius"] = probe.contact->radius;
    }
    if (probe.probe >= 0) result["probe"] = probe.probe;
    if (!probe.times.empty()) result["times"] = probe.times;
    if (probe.turn) result["turn"] = {{"axis", numbers(probe.turn->axis)}, {"degrees", probe.turn->degrees}};
    if (probe.sigmas > 0) {
        result["difference_mm"] = probe.rms_mm;
        result["difference_sigmas"] = probe.sigmas;
    }
    return result;
}

json baseline_of(const identify::Diagnosis& diagnosis, const identify::BodyModel& model) {
    json result = baseline_json(model, diagnosis.problem, diagnosis.baseline);
    const identify::FitErrors errors = identify::errors_of(diagnosis.problem, diagnosis.baseline);
    result["rms_mm"] = errors.rms;
    result["relative"] = known(errors.relative);
    result["whitened_rms"] = errors.whitened_rms;
    result["held_out_rms_mm"] = known(diagnosis.baseline_held_out.rms_mm);
    result["held_out_whitened_rms"] = known(diagnosis.baseline_held_out.whitened_rms);
    add_forces(result, errors.rms_n, diagnosis.baseline_held_out);
    if (errors.load_exponent) {
        result["load_exponent"] = {{"value", errors.load_exponent->value},
                                   {"sd", errors.load_exponent->sd},
                                   {"words", errors.load_exponent->words}};
    }
    return result;
}

/// What is fitted with the explanation in force; null where none is claimed.
json explained_of(const identify::Diagnosis& diagnosis, const identify::BodyModel& model) {
    if (!diagnosis.explained) return nullptr;
    json result = baseline_json(model, diagnosis.problem, diagnosis.explained->fit);
    result["rms_mm"] = known(diagnosis.explained->fit.rms_mm);
    result["whitened_rms"] = known(diagnosis.explained->fit.whitened_rms);
    result["held_out_rms_mm"] = known(diagnosis.explained->held_out.rms_mm);
    add_forces(result, diagnosis.explained->fit.rms_n, diagnosis.explained->held_out);
    return result;
}

/// Readings that are off by themselves, as the files name them.
json outlier_readings(const identify::Diagnosis& diagnosis, const identify::MeasurementSet& set) {
    json result = json::array();
    if (diagnosis.outliers.readings.empty()) return result;
    const identify::Problem whole = identify::make_problem(set, 1);
    std::vector<int> first_row(whole.readings(), -1);
    for (int n = static_cast<int>(whole.rows()) - 1; n >= 0; --n) first_row[whole.reading[n]] = n;
    for (const int reading : diagnosis.outliers.readings) {
        const int n = first_row[reading];
        const identify::LoadState& state = set.states[whole.state[n]];
        result.push_back(
            {{"probe", state.probe}, {"time", state.time}, {"marker", set.markers[whole.coordinate[n] / 3].id}});
    }
    return result;
}

/// Pairs whose labels look swapped.
json exchanged_markers(const identify::Diagnosis& diagnosis, const identify::MeasurementSet& set) {
    json result = json::array();
    for (const identify::ExchangedMarkers& one : diagnosis.outliers.exchanged) {
        const identify::LoadState& state = set.states[one.state];
        result.push_back({{"probe", state.probe},
                          {"time", state.time},
                          {"markers", {set.markers[one.markers.first].id, set.markers[one.markers.second].id}}});
    }
    return result;
}

/// What is left, located; null where nothing is.
json where_of(const identify::Diagnosis& diagnosis, const identify::MeasurementSet& set, const std::string& field) {
    if (!diagnosis.missing) return nullptr;
    const identify::MissingSource& source = *diagnosis.missing;
    json states = json::array(), evidence = json::object();
    for (const int s : source.states) states.push_back({{"probe", set.states[s].probe}, {"time", set.states[s].time}});
    for (std::size_t kind = 0; kind < identify::source_kind_names.size(); ++kind)
        evidence[identify::source_kind_names[kind]] = known(source.log_bayes_factors[kind]);
    const bool has_direction = source.direction.norm() > 0;
    constexpr double degrees = 180 / M_PI;
    json magnitude = nullptr;
    if (const auto size = source.magnitude())
        magnitude = {{"value", known(size->value)}, {"sd", known(size->sd)}, {"unit", size->unit}};
    return {{"states", states},
            {"at", numbers(source.at)},
            {"spread_mm", source.spread},
            {"direction", has_direction ? numbers(source.direction) : json(nullptr)},
            {"direction_sd_degrees", has_direction ? known(degrees * source.direction_sd) : json(nullptr)},
            {"kind", identify::source_kind_names[static_cast<std::size_t>(source.kind)]},
            {"law", identify::source_law_names[static_cast<std::size_t>(source.likeliest().law)]},
            {"magnitude", magnitude},
            {"log_bayes_factor", known(source.log_bayes_factor())},
            {"log_bayes_factors", evidence},
            {"explained", source.explained},
            {"sentence", source.sentence()},
            {"field", field.empty() ? json(nullptr) : json(field)}};
}

}  // namespace

json to_json(const identify::Diagnosis& diagnosis, const identify::BodyModel& model,
             const identify::MeasurementSet& set, const std::string& field) {
    json ranking = json::array();
    for (const identify::Candidate& candidate : diagnosis.ranking) ranking.push_back(to_json(candidate, model));
    return {{"format", "palpate-diagnosis/1"},
            {"verdict", identify::verdict_names[static_cast<std::size_t>(diagnosis.verdict)]},
            {"false_claim_rate", diagnosis.false_claims},
            {"explanation", diagnosis.explanation},
            {"ranking", ranking},
            {"where", where_of(diagnosis, set, field)},
            {"next_probe", diagnosis.next_probe ? to_json(*diagnosis.next_probe) : json(nullptr)},
            {"law", model.laws()[diagnosis.law]},
            {"noise_mm", known(diagnosis.noise)},
            {"noise_known", diagnosis.noise_known},
            {"independent_readings", diagnosis.independent},
            {"baseline", baseline_of(diagnosis, model)},
            {"explained", explained_of(diagnosis, model)},
            {"outlier_readings", outlier_readings(diagnosis, set)},
            {"exchanged_markers", exchanged_markers(diagnosis, set)},
            {"notes", diagnosis.notes}};
}

}  // namespace palpate::pipeline
