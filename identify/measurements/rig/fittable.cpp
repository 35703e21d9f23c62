#include "identify/measurements/rig/fittable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/loading/loads.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// How many readings' noise each reading shares, itself among them: sum_j exp(-d_ij^2 / (2 length^2)) over those of its
/// state, by where they rest.
double sharing(const MeasurementSet& set, const LoadState& state, const Reading& one, double length) {
    double sum = 0;
    for (const Reading& other : state.readings) {
        if (!is_usable(other)) continue;
        const double d = (set.markers[other.marker].rest - set.markers[one.marker].rest).norm() / length;
        sum += std::exp(-0.5 * d * d);
    }
    return sum;
}

bool acts_with_force(const MeasurementSet& set, const Actuation& actuation) {
    const auto* tendon =
        std::get_if<mesh::TendonActuator>(&set.actuators[static_cast<std::size_t>(actuation.actuator)].kind);
    return actuation.value != 0 && !(tendon && tendon->by_length);
}

}  // namespace

std::vector<UnfittedPart> parts_not_fitted_yet(const MeasurementSet& set) {
    std::vector<UnfittedPart> parts;
    const bool is_noise_told =
        set.position_noise || std::ranges::all_of(set.states, [](const LoadState& state) {
            return std::ranges::none_of(state.readings, [](const Reading& one) { return std::isnan(one.sigma); });
        });
    if (set.position_correlation && !is_noise_told)
        parts.push_back({fmt::format("'correlated.position' ({:.4g} mm) and no noise", *set.position_correlation),
                         "noise that neighbours share cannot be estimated from what a fit leaves. Give "
                         "'noise.position' in set.yaml, or a sigma for each reading"});
    return parts;
}

std::string in_words(const std::vector<UnfittedPart>& parts) {
    std::vector<std::string> names, remedies;
    for (const UnfittedPart& part : parts) {
        names.push_back(part.what);
        if (std::ranges::find(remedies, part.remedy) == remedies.end()) remedies.push_back(part.remedy);
    }
    return fmt::format("{}: {}", fmt::join(names, ", "), fmt::join(remedies, ". Also, "));
}

void require_fittable(const MeasurementSet& set) {
    const std::vector<UnfittedPart> parts = parts_not_fitted_yet(set);
    if (!parts.empty())
        throw InvalidInput(fmt::format("set '{}': it cannot be fitted yet with {}.", set.name, in_words(parts)));
}

void take_displacements_from_rest(MeasurementSet& set) {
    int taken = 0;
    for (LoadState& state : set.states)
        for (Reading& reading : state.readings) {
            if (!reading.since) continue;
            const LoadState* reference = find_state(set, *reading.since);
            if (!reference || is_known_to_act(set, *reference)) continue;
            reading.since.reset();
            ++taken;
        }
    if (taken > 0)
        set.notes.push_back(
            fmt::format("{} displacements count from a state in which nothing is known to act: they are taken as "
                        "positions, from rest.",
                        taken));
}

void take_correlated_noise(MeasurementSet& set) {
    if (!set.position_correlation || !parts_not_fitted_yet(set).empty()) return;
    double most = 1;
    for (LoadState& state : set.states) {
        std::vector<double> shared;
        for (const Reading& one : state.readings)
            shared.push_back(one.marker < 0 ? 1 : sharing(set, state, one, *set.position_correlation));
        for (std::size_t r = 0; r < shared.size(); ++r) {
            Reading& one = state.readings[r];
            one.sigma = std::sqrt(shared[r]) * (std::isnan(one.sigma) ? *set.position_noise : one.sigma);
            most = std::max(most, shared[r]);
        }
    }
    set.notes.push_back(
        fmt::format("Neighbours within {:.3g} mm err alike: up to {:.0f} readings count as one, by a larger noise.",
                    *set.position_correlation, most));
    set.position_correlation.reset();
}

bool tells_a_force(const MeasurementSet& set) {
    return std::ranges::any_of(set.states, [&](const LoadState& state) {
        const bool is_heavy = set.density && !known_gravity(set, state).value_or(Vec3::Zero()).isZero(0);
        return is_heavy || has_contact_force(state) || known_pressure(state) != 0 || !state.reactions.empty() ||
               std::ranges::any_of(state.actuations,
                                   [&](const Actuation& actuation) { return acts_with_force(set, actuation); });
    });
}

}  // namespace palpate::identify
