#include "identify/comparison/compare.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "identify/comparison/load_exponent.h"
#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "identify/inference/domains/position/solver_pool.h"
#include "identify/loading/history/load_history.h"
#include "identify/loading/readings.h"
#include "identify/loading/reduced_load.h"
#include "identify/numerics/parallel.h"
#include "identify/numerics/summaries.h"
#include "mesh/errors.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

bool is_loaded_from_outside(const LoadState& state) {
    return !state.motions.empty() || !state.actuations.empty() || has_contact_force(state);
}

constexpr double adequate_rms = 1.1;       // in sigmas: with thousands of readings no p-value forgives rounding
constexpr double adequate_p_value = 1e-3;  // what is right is refused once in a thousand times, as by a diagnosis
constexpr int worst_readings = 10;         // that are listed

double square(double x) { return x * x; }

/// Markers of each state at the model's equilibria; `bears_full_load` is 0 where it does not bear the whole load.
std::vector<Points> predict(const skeleton::Model& model, const std::vector<StateReadings>& states, int threads,
                            std::vector<char>& bears_full_load) {
    std::vector<Points> predicted(states.size());
    SolverPool solvers(model, states);
    const Eigen::VectorXd k = stiffness_vector(model);
    std::vector<skeleton::Equilibrium> equilibria(states.size());
    for_each_in_parallel(static_cast<int>(states.size()), is_history_dependent(states) ? 1 : threads, [&](int s) {
        const SolverPool::Loan solver(solvers);
        const LoadHistory before = reduced_load_history_before(model, *solver, k, states, s, equilibria);
        ReducedLoadEquilibrium found = solve_with_reduced_load(*solver, k, states[s].load, before.flowed);
        bears_full_load[s] = before.is_full_load && found.is_full_load;
        predicted[s] = observed(model, found.equilibrium, found.load, states[s].points);
        equilibria[s] = std::move(found.equilibrium);
    });
    return predicted;
}

ProbeError error_of(const LoadState& state, const StateReadings& readings, const Points& error) {
    double largest = 0;
    for (const auto& row : error.rowwise()) largest = std::max(largest, known_part(row.transpose()).norm());
    const double left = rms(error);
    return {state.probe, state.time, left, largest, readings.displacement > 0 ? left / readings.displacement : missing};
}

/// Sums over all measured coordinates.
struct Totals {
    int coordinates = 0;
    double error = 0, displacement = 0, noise = 0;  // of squares [mm^2]
    double chi_squared = 0;                         // NaN when a noise is unknown

    void add(const StateReadings& readings, const Points& difference) {
        coordinates += readings.coordinates;
        displacement += readings.coordinates * square(readings.displacement);
        for (Eigen::Index i = 0; i < difference.rows(); ++i) {
            const int measured = static_cast<int>((!difference.row(i).array().isNaN()).count());
            const double squares = known_part(difference.row(i).transpose()).squaredNorm();
            error += squares;
            noise += measured * square(readings.noise[i]);
            chi_squared += squares / square(readings.noise[i]);
        }
    }
};

/// Noise of a state, rms over its coordinates; 0 when unknown.
double noise_of(const StateReadings& readings) {
    return known_part(std::sqrt(readings.noise.squaredNorm() / static_cast<double>(readings.noise.size())));
}

void find_worst(const MeasurementSet& set, const std::vector<StateReadings>& states, const std::vector<Points>& errors,
                Comparison& result) {
    for (std::size_t s = 0; s < states.size(); ++s) {
        const LoadState& state = set.states[states[s].state];
        for (Eigen::Index i = 0; i < errors[s].rows(); ++i) {
            const Vec3 error = known_part(errors[s].row(i).transpose());
            const Reading& reading = state.readings[states[s].rows[i]];
            result.worst.push_back({set.markers[reading.marker].id, state.probe, state.time, error.norm(),
                                    reading.position, error.normalized()});
        }
    }
    std::ranges::stable_sort(result.worst, std::greater{}, &WorstReading::error);
    if (result.worst.size() > worst_readings) result.worst.resize(worst_readings);
}

/// `predicted`: as RiggedPrediction tells them.
std::optional<ReactionError> error_of_reactions(const MeasurementSet& set, const std::vector<Points>& predicted) {
    ReactionError result;
    double error = 0, measured = 0;
    int components = 0;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        for (std::size_t r = 0; r < set.states[s].reactions.size(); ++r) {
            const Vec3& force = set.states[s].reactions[r].force;
            if (force.array().isNaN().all()) continue;
            result.forces.push_back({set.states[s].probe, set.states[s].time, set.states[s].reactions[r].tool, force,
                                     predicted[s].row(2 * static_cast<Eigen::Index>(r)).transpose()});
            for (int axis = 0; axis < 3; ++axis) {
                if (std::isnan(force[axis])) continue;
                const double off = force[axis] - predicted[s](2 * static_cast<Eigen::Index>(r), axis);
                error += off * off;
                measured += force[axis] * force[axis];
                result.max = std::max(result.max, std::abs(off));
                ++components;
            }
        }
    }
    if (components == 0) return std::nullopt;
    result.rms = std::sqrt(error / components);
    result.relative = measured > 0 ? std::sqrt(error / measured) : missing;
    return result;
}

}  // namespace

Comparison compare(const skeleton::Model& model, const MeasurementSet& set, int threads) {
    const std::vector<StateReadings> states = collect_readings(model, set);
    const bool reads_forces =
        std::ranges::any_of(set.states, [](const LoadState& state) { return !state.reactions.empty(); });
    if (states.empty() && !reads_forces) {
        throw InvalidInput("measurement set '" + set.name +
                           "' has no labelled reading to compare with; positions.csv "
                           "needs rows that name a marker");
    }
    std::vector<char> bears_full_load(states.size(), 1);
    std::vector<Points> predicted;
    std::optional<ReactionError> reactions;
    if (is_rigged(set)) {
        const RiggedPrediction all = predict_rigged(model, set, threads);
        for (const StateReadings& state : states)
            predicted.push_back(all.positions[state.state](state.rows, Eigen::all));
        reactions = error_of_reactions(set, all.reactions);
    } else {
        predicted = predict(model, states, threads, bears_full_load);
    }

    Comparison result;
    result.reactions = reactions;
    for (std::size_t s = 0; s < states.size(); ++s) {
        const int probe = set.states[states[s].state].probe;
        const bool is_new = result.overloaded_probes.empty() || result.overloaded_probes.back() != probe;
        if (!bears_full_load[s] && is_new) result.overloaded_probes.push_back(probe);
    }
    for (const LoadState& state : set.states) {
        result.predicted.emplace_back(Points::Constant(static_cast<Eigen::Index>(state.readings.size()), 3, missing));
    }
    Totals totals;
    std::vector<Points> errors;
    std::vector<ErrorUnderLoad> under_load;
    for (std::size_t s = 0; s < states.size(); ++s) {
        const LoadState& state = set.states[states[s].state];
        result.predicted[states[s].state](states[s].rows, Eigen::all) = predicted[s];
        errors.emplace_back(states[s].measured - predicted[s]);
        totals.add(states[s], errors[s]);
        result.probes.push_back(error_of(state, states[s], errors[s]));
        result.max = std::max(result.max, result.probes.back().max);
        under_load.push_back({rms(predicted[s] - states[s].rest), result.probes.back().rms, noise_of(states[s]),
                              states[s].coordinates, is_loaded_from_outside(state)});
    }
    if (totals.coordinates == 0) {
        if (!reactions)
            throw InvalidInput("measurement set '" + set.name +
                               "' tells neither a position nor a force that a model could answer: positions.csv needs "
                               "rows that name a marker, or reactions.csv forces (fx, fy, fz) of tools that are moved");
        result.relative = reactions->relative;
        return result;
    }
    result.rms = std::sqrt(totals.error / totals.coordinates);
    result.relative = totals.displacement > 0 ? std::sqrt(totals.error / totals.displacement) : missing;
    find_worst(set, states, errors, result);
    result.load_exponent = load_exponent(under_load);

    // is what is left noise? chi^2 with as many degrees of freedom as coordinates
    if (!std::isnan(totals.noise) && totals.noise > 0) {
        result.noise = std::sqrt(totals.noise / totals.coordinates);
        result.p_value = boost::math::gamma_q(totals.coordinates / 2.0, totals.chi_squared / 2);
        result.adequate =
            std::sqrt(totals.chi_squared / totals.coordinates) <= adequate_rms || result.p_value >= adequate_p_value;
    }
    return result;
}

}  // namespace palpate::identify
