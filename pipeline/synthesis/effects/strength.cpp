#include "pipeline/synthesis/effects/strength.h"

#include <cmath>

namespace palpate::pipeline {
namespace {

/// All coordinates one after the other.
Eigen::VectorXd stacked(const std::vector<Points>& readings) {
    Eigen::Index size = 0;
    for (const Points& state : readings) size += state.size();
    Eigen::VectorXd all(size);
    Eigen::Index at = 0;
    for (const Points& state : readings) {
        all.segment(at, state.size()) = Eigen::Map<const Eigen::VectorXd>(state.data(), state.size());
        at += state.size();
    }
    return all;
}

double rms(const Eigen::VectorXd& values) {
    return values.size() > 0 ? std::sqrt(values.squaredNorm() / static_cast<double>(values.size())) : 0;
}

Strength strength_from(const std::vector<Points>& amounts, const std::vector<Points>& changes) {
    const Eigen::VectorXd u = stacked(amounts), change = stacked(changes);
    const double scaling = u.squaredNorm() > 0 ? change.dot(u) / u.squaredNorm() : 0;
    return {rms(u), rms(change), rms(change - scaling * u)};
}

}  // namespace

double rms(const std::vector<Points>& readings) { return rms(stacked(readings)); }

Strength strength_of(const Specimen& specimen, const std::vector<Points>& baseline, const std::vector<Points>& hidden) {
    const auto markers = static_cast<Eigen::Index>(specimen.set.markers.size());
    Points rest(markers, 3);
    for (Eigen::Index m = 0; m < markers; ++m) rest.row(m) = specimen.set.markers[m].rest;
    std::vector<Points> displacements, changes;
    for (std::size_t s = 0; s < baseline.size(); ++s) {
        if (!hidden[s].allFinite()) continue;  // it found no equilibrium
        displacements.emplace_back(baseline[s] - rest);
        changes.emplace_back(hidden[s] - baseline[s]);
    }
    return strength_from(displacements, changes);
}

Strength strength_in_forces(const std::vector<Points>& bare, const std::vector<Points>& hidden) {
    std::vector<Points> forces, changes;
    for (std::size_t row = 0; row < bare.size(); ++row) {
        if (!hidden[row].allFinite()) continue;
        forces.push_back(bare[row]);
        changes.emplace_back(hidden[row] - bare[row]);
    }
    return strength_from(forces, changes);
}

void Strength::add(double variance) {
    for (double* rms : {&change, &beyond}) *rms = std::sqrt(*rms * *rms + variance);
}

}  // namespace palpate::pipeline
