#include "pipeline/analysis/quality/errors.h"

#include <algorithm>
#include <cmath>

namespace palpate::pipeline {
namespace {

/// Between the two nearest values, linearly. @pre ascending.
double quantile(const std::vector<double>& values, double share) {
    const double at = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace

std::vector<ProbeDeviation> deviations(const identify::MeasurementSet& set, const std::vector<Points>& predicted) {
    std::vector<ProbeDeviation> result;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const identify::LoadState& state = set.states[s];
        if (state.contacts.empty()) continue;
        double error = 0, displacement = 0;  // squared
        Vec3 force = Vec3::Zero();
        for (const mesh::Contact& contact : state.contacts) force += contact.force;
        for (std::size_t r = 0; r < state.readings.size(); ++r) {
            const identify::Reading& reading = state.readings[r];
            error += (predicted[s].row(static_cast<Eigen::Index>(r)).transpose() - reading.position).squaredNorm();
            displacement += (reading.position - set.markers[reading.marker].rest).squaredNorm();
        }
        result.push_back({std::sqrt(error), std::sqrt(displacement), force.norm()});
    }
    return result;
}

ErrorSummary summarise(const std::vector<ProbeDeviation>& deviations) {
    std::vector<double> relative;
    double squares = 0, error = 0, displacement = 0;
    for (const ProbeDeviation& probe : deviations) {
        relative.push_back(probe.error / probe.displacement);
        squares += relative.back() * relative.back();
        error += std::pow(probe.error / probe.force, 2);
        displacement += std::pow(probe.displacement / probe.force, 2);
    }
    std::ranges::sort(relative);
    const auto count = static_cast<double>(relative.size());
    return {static_cast<int>(relative.size()), std::sqrt(squares / count), quantile(relative, 0.5),
            quantile(relative, 0.9), std::sqrt(error / displacement)};
}

}  // namespace palpate::pipeline
