#include "pipeline/output/json/preflight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/numerics/summaries.h"
#include "pipeline/output/text/preflight.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json finite(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json point(const Vec3& at) { return {at.x(), at.y(), at.z()}; }

json state_name(const identify::MeasurementSet& set, int state) {
    const identify::LoadState& one = set.states[static_cast<std::size_t>(state)];
    return {{"probe", one.probe}, {"time", one.time}};
}

std::string state_words(const identify::MeasurementSet& set, int state) {
    const identify::LoadState& one = set.states[static_cast<std::size_t>(state)];
    return fmt::format("probe {} at {:g} s", one.probe, one.time);
}

/// 95 % of a number of the fit, as it is reported.
json parameter_json(const identify::ParameterProspect& one, const std::string& name, const std::string& unit,
                    double (*reported)(double)) {
    const double reach = identify::sds_of_95_percent * one.sd;
    const double a = reported(one.value - reach), b = reported(one.value + reach);
    return {{"name", name},
            {"unit", unit},
            {"value", reported(one.value)},
            {"q025", std::min(a, b)},
            {"q975", std::max(a, b)},
            {"narrows_prior_to", one.sd / one.prior_sd},
            {"informed", one.informed()}};
}

double poisson_of(double compressibility) { return 0.5 * (1 - std::exp(compressibility)); }
double young_of(double logarithm) { return std::exp(logarithm); }

json parameters_json(const identify::Preflight& preflight) {
    json result = json::array();
    for (const identify::ParameterProspect& one : preflight.parameters.material) {
        const bool is_young = one.name != "compressibility";  // of the body, or of a region
        result.push_back(is_young ? parameter_json(one, one.name, "MPa", young_of)
                                  : parameter_json(one, "poisson", "1", poisson_of));
        // Without a force nothing has the unit of one.
        if (is_young && !preflight.tells_a_force) result.back()["informed"] = false;
    }
    return result;
}

json own_json(const std::optional<identify::OwnNumber>& own) {
    if (!own || !std::isfinite(own->value)) return nullptr;
    return {{"name", own->name}, {"value", own->value}, {"unit", own->unit}, {"at_most", own->at_most}};
}

const char* whether(const identify::EffectProspect& one) {
    constexpr double nearly_all = 0.9;  // of the cases that the prior expects
    if (!one.why_not.empty()) return "no";
    return one.share >= nearly_all ? "yes" : one.share >= sufficient_share ? "mostly" : one.share > 0 ? "partly" : "no";
}

/// Why an effect cannot be named that could show.
std::string held_up(const identify::EffectProspect& one) {
    if (!one.why_not.empty()) return one.why_not;
    if (one.share >= sufficient_share) return {};
    if (std::isfinite(one.seen) && one.seen <= 1 && !one.confused_with.empty())
        return fmt::format("as strong as its prior expects, it is detectable, but indistinguishable from {}",
                           listed(one.confused_with));
    if (std::isfinite(one.least))
        return fmt::format("it would have to be {:.2g} times as strong as its prior expects", one.least);
    return one.confused_with.empty() ? "not identifiable at any strength"
                                     : "indistinguishable from " + listed(one.confused_with) + " at any strength";
}

json effect_json(const identify::EffectProspect& one) {
    return {{"effect", one.effect->name()},
            {"kind", one.effect->is_of_body() ? "body" : "measurement"},
            {"can_be_named", whether(one)},
            {"share", one.share},
            {"least",
             {{"of_prior", finite(one.least)},
              {"rms_sigma", one.why_not.empty() ? finite(one.rms_sigma) : json(nullptr)},
              {"rms_mm", one.why_not.empty() ? finite(one.rms_mm) : json(nullptr)},
              {"max_mm", one.why_not.empty() ? finite(one.max_mm) : json(nullptr)},
              {"own", own_json(one.own)}}},
            {"easiest", {{"of_prior", finite(one.easiest)}, {"own", own_json(one.own_easiest)}}},
            {"prior", {{"rms_mm", finite(one.prior_rms_mm)}, {"own", own_json(one.own_prior)}}},
            {"seen_from_of_prior", finite(one.seen)},
            {"confused_with", one.confused_with},
            {"why_not", held_up(one)}};
}

std::string suspicion_words(const identify::Suspicion& one, const identify::MeasurementSet& set) {
    const std::string marker = label_of(set.markers[static_cast<std::size_t>(one.marker)]);
    const std::string where = one.state >= 0 ? state_words(set, one.state) : "";
    switch (one.kind) {
        case identify::Suspect::rough:
            return fmt::format("Marker {} in {} is {:.2g} mm off what its neighbours do.", marker, where, one.mm);
        case identify::Suspect::jump:
            return fmt::format("Marker {} jumps in {}: {:.2g} mm off the states before and after.", marker, where,
                               one.mm);
        case identify::Suspect::everywhere:
            return fmt::format(
                "Marker {} is off its neighbours in most states, by {:.2g} mm at most: its place at rest, "
                "or its name, may be wrong.",
                marker, one.mm);
        case identify::Suspect::far:
            return fmt::format(
                "Marker {} rests {:.2g} mm outside the surface, attached to nothing: columns ax, ay, az "
                "say to what.",
                marker, one.mm);
        case identify::Suspect::exchanged:
            return fmt::format("Markers {} and {} look exchanged in {}.", marker,
                               label_of(set.markers[static_cast<std::size_t>(one.other)]), where);
    }
    return {};
}

json suspicion_json(const identify::Suspicion& one, const identify::MeasurementSet& set) {
    const identify::Marker& marker = set.markers[static_cast<std::size_t>(one.marker)];
    json result{{"kind", identify::suspect_names[static_cast<std::size_t>(one.kind)]},
                {"marker", label_of(marker)},
                {"state", one.state >= 0 ? state_name(set, one.state) : json(nullptr)},
                {"at", point(marker.rest)},
                {"mm", one.mm},
                {"sigmas", one.sigmas > 0 ? json(one.sigmas) : json(nullptr)},
                {"words", suspicion_words(one, set)}};
    if (one.other >= 0) result["other"] = label_of(set.markers[static_cast<std::size_t>(one.other)]);
    return result;
}

json repeat_json(const identify::Repeat& one, const identify::MeasurementSet& set, bool noise_known) {
    json states = json::array();
    std::string names;
    constexpr std::size_t most_named = 6;  // that a sentence has room for
    for (std::size_t i = 0; i < one.states.size(); ++i) {
        states.push_back(state_name(set, one.states[i]));
        if (i < most_named) names += (i == 0 ? "" : ", ") + state_words(set, one.states[i]);
    }
    if (one.states.size() > most_named) names += fmt::format(" and {} more", one.states.size() - most_named);
    constexpr double more = 1.5;  // of the noise
    const bool is_more = one.sd_mm > more * one.sigma_mm;
    const std::string beside =
        fmt::format(" the noise is {} {:.2g} mm", noise_known ? "declared as" : "assumed to be", one.sigma_mm);
    const std::string what = one.held ? "One load, held or taken again" : one.loaded ? "The same load" : "Without load";
    const std::string hint = !is_more   ? ""
                             : one.held ? " Creep, or a noise that is larger than that."
                             : one.loaded
                                 ? " The noise is larger than that, or the body remembers, or the set-up moved."
                                 : " The noise is larger than that, or the body or the frame did not come back.";
    return {{"states", states},
            {"loaded", one.loaded},
            {"sd_mm", one.sd_mm},
            {"noise_mm", one.sigma_mm},
            {"freedoms", one.freedoms},
            {"words", fmt::format("{}: {} repeat to {:.2g} mm (1 sigma);{}.{}", what, names, one.sd_mm, beside, hint)}};
}

json experiment_json(const identify::ExperimentProspect& one) {
    json gains = json::array();
    for (const identify::ExperimentGain& gain : one.gains) {
        gains.push_back({{"effect", gain.effect},
                         {"share_before", gain.share_before},
                         {"share_after", gain.share_after},
                         {"least_before", finite(gain.least_before)},
                         {"least_after", finite(gain.least_after)}});
    }
    return {{"kind", one.experiment.kind},
            {"words", one.experiment.words},
            {"states", one.experiment.states.size()},
            {"opens", one.opens},
            {"gains", gains}};
}

}  // namespace

json to_json(const identify::Preflight& preflight, const identify::ReferenceBody& body,
             const identify::MeasurementSet& set) {
    const fem::Material material = body.material(preflight.guess.setting());
    json result{{"guess",
                 {{"young_mpa", material.young},
                  {"poisson", material.poisson},
                  {"from", preflight.guess_is_sets ? "set" : "readings"},
                  {"law", body.laws()[static_cast<std::size_t>(preflight.guess.law)]}}},
                {"noise_mm", preflight.noise_mm},
                {"noise_known", preflight.noise_known},
                {"moved_mm", preflight.moved_mm},
                {"nuisance_mm", preflight.nuisance_mm},
                {"coordinates", preflight.coordinates},
                {"independent", preflight.independent},
                {"tells_a_force", preflight.tells_a_force},
                {"parameters", parameters_json(preflight)},
                {"parts", json::array()},
                {"effects", json::array()},
                {"suspicions", json::array()},
                {"repeats", json::array()},
                {"experiments", json::array()}};
    for (const identify::PartProspect& part : preflight.parameters.parts) {
        result["parts"].push_back({{"at", point(part.at)},
                                   {"sd_of_log_stiffness", part.stiffness.sd},
                                   {"informed", part.stiffness.informed()}});
    }
    for (const identify::EffectProspect& one : preflight.effects) result["effects"].push_back(effect_json(one));
    for (const identify::Suspicion& one : preflight.suspicions)
        result["suspicions"].push_back(suspicion_json(one, set));
    for (const identify::Repeat& one : preflight.repeats)
        result["repeats"].push_back(repeat_json(one, set, preflight.noise_known));
    for (const identify::ExperimentProspect& one : preflight.experiments)
        result["experiments"].push_back(experiment_json(one));
    return result;
}

}  // namespace palpate::pipeline
