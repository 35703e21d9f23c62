#include "pipeline/analysis/forecast/forecast.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "identify/inference/domains/position/solver_pool.h"
#include "identify/inference/particles/resampling.h"
#include "identify/loading/creep.h"
#include "identify/loading/loads.h"
#include "identify/numerics/parallel.h"
#include "identify/numerics/summaries.h"
#include "mesh/errors.h"
#include "pipeline/analysis/playback.h"
#include "skeleton/effects/effect.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::pipeline {
namespace {

constexpr double own_share = 0.5;  // of a place's squared error, that goes with its own displacement

/// 97.5 % of Student's t with so many degrees of freedom, the Gaussian's for 0 [Abramowitz and Stegun 1964, 26.7.5];
/// off by 1 % for three.
double student_97_5(int freedom) {
    if (freedom == 0) return identify::sds_of_95_percent;
    const double z = identify::sds_of_95_percent, n = freedom;
    return z + (std::pow(z, 3) + z) / (4 * n) + (5 * std::pow(z, 5) + 16 * std::pow(z, 3) + 3 * z) / (96 * n * n) +
           (3 * std::pow(z, 7) + 19 * std::pow(z, 5) + 17 * std::pow(z, 3) - 15 * z) / (384 * n * n * n);
}

/// A probe's mean square error, beyond the noise: (relative u_rms)^2, and more where it moves the body so little that
/// its error goes by what others move it; less of the latter for a small force. [mm^2]
double mean_square_error(const Points& u, double share_of_force, const identify::ForecastError& error) {
    const double whole = u.squaredNorm() / static_cast<double>(u.size());
    const double least = std::pow(std::min(1.0, share_of_force) * error.least_displacement, 2);
    return std::pow(error.relative * student_97_5(error.probes) / identify::sds_of_95_percent, 2) * (whole + least);
}

/// How a mean square error is spread over the vertices, where they move by u (vertices x 3); 1 on average.
///
/// Half of it is alike everywhere and half goes with the square of a place's own displacement: of quarters of the
/// markers by displacement, on the bracket, the organ and two-effects, that gives 1.5, 1.0, 0.8 and 0.7 of the rms
/// error; 1.4, 0.9, 0.8 and 0.6 were measured.
Eigen::VectorXd pattern_of_error(const Points& u) {
    const Eigen::VectorXd squares = u.rowwise().squaredNorm();
    if (squares.isZero(0)) return Eigen::VectorXd::Ones(u.rows());
    return own_share * squares.array() / squares.mean() + (1 - own_share);
}

/// Of a coordinate at each vertex, by the draws [mm^2].
Eigen::VectorXd variance_of(const std::vector<Points>& drawn, const Points& u) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(u.rows());
    for (const Points& other : drawn) sum += (other - u).rowwise().squaredNorm();
    return sum / (3 * static_cast<double>(drawn.size()));
}

/// Of what draws and the model's own error leave open of a displacement. What probes were off by that the fit had not
/// seen has the stiffness's part in it: the model's own is the rest.
void set_spread(const std::vector<Points>& drawn, double mean_square, Forecast& forecast) {
    const Points& u = forecast.displacement;
    const Eigen::VectorXd by_stiffness = variance_of(drawn, u);
    const Eigen::VectorXd own = std::max(0.0, mean_square - by_stiffness.mean()) * pattern_of_error(u);
    forecast.sd = (by_stiffness + own).cwiseSqrt();

    Eigen::Index most = 0;
    u.rowwise().norm().maxCoeff(&most);
    Eigen::VectorXd there(drawn.size());
    for (std::size_t d = 0; d < drawn.size(); ++d) there[static_cast<Eigen::Index>(d)] = drawn[d].row(most).norm();
    const Eigen::VectorXd weights = Eigen::VectorXd::Constant(there.size(), 1.0 / static_cast<double>(there.size()));
    const auto away = [&](double quantile) {
        return std::hypot(identify::weighted_quantile(there, weights, quantile) - forecast.largest,
                          identify::sds_of_95_percent * std::sqrt(own[most]));
    };
    forecast.low = std::max(0.0, forecast.largest - away(0.025));
    forecast.high = forecast.largest + away(0.975);
}

/// A load's forces, of the largest that was measured.
double share_of_force(const skeleton::Load& load, const identify::MeasuredRange& measured) {
    double force = 0;
    for (const skeleton::PointForce& point : load.forces) force += point.force.norm();
    return measured.force > 0 ? force / measured.force : 1;
}

/// Loads that one body bears one after another.
using LoadSequence = std::vector<skeleton::Load>;

/// Where nothing is kept from state to state, each is a life of its own.
std::vector<LoadSequence> load_sequences(const skeleton::Model& model, const std::vector<identify::LoadState>& states) {
    const fem::Effects physics = skeleton::physics_of(model.effects);
    identify::MeasurementSet set;
    set.states = states;
    if (physics.creep) set = identify::as_elastic(set, *physics.creep);
    const identify::ContactLoads to_load(model);
    std::vector<LoadSequence> sequences;
    for (std::size_t s = 0; s < states.size(); ++s) {
        const bool goes_on = physics.remember() && s > 0 && states[s].probe == states[s - 1].probe;
        if (!goes_on) sequences.emplace_back();
        sequences.back().push_back(to_load(set.states[s].contacts));
    }
    return sequences;
}

std::string probes_in_words(std::vector<int> probes) {
    probes.erase(std::unique(probes.begin(), probes.end()), probes.end());
    constexpr std::size_t most = 8;  // that a sentence has room for
    const bool all = probes.size() <= most;
    if (!all) probes.resize(most);
    return fmt::format("{} {}{}", probes.size() == 1 ? "Probe" : "Probes", fmt::join(probes, ", "), all ? "" : ", ...");
}

}  // namespace

std::vector<Forecast> forecast(const skeleton::Model& model, const std::vector<identify::LoadState>& states,
                               const std::optional<ModelUncertainty>& uncertainty, int threads) {
    const std::vector<LoadSequence> sequences = load_sequences(model, states);
    std::vector<std::vector<Forecast>> of_sequences(sequences.size());
    std::vector<skeleton::Load> loads;
    for (const LoadSequence& sequence : sequences) std::ranges::copy(sequence, std::back_inserter(loads));
    identify::SolverPool solvers(model, std::move(loads));
    const Eigen::VectorXd k = skeleton::stiffness_vector(model);
    identify::for_each_in_parallel(static_cast<int>(sequences.size()), threads, [&](int l) {
        const identify::SolverPool::Loan solver(solvers);
        skeleton::FibreStates before;
        std::vector<skeleton::FibreStates> before_by_draws(uncertainty ? uncertainty->draws.size() : 0);
        for (const skeleton::Load& load : sequences[l]) {
            Forecast& here = of_sequences[l].emplace_back();
            here.equilibrium = solver->solve(k, load, {}, nullptr, before);
            before = skeleton::flowed(model, here.equilibrium);
            here.displacement = skin_displacement(model, here.equilibrium, load);
            here.largest = here.displacement.rows() > 0 ? here.displacement.rowwise().norm().maxCoeff() : 0;
            here.low = here.high = here.largest;
            if (!uncertainty || here.displacement.rows() == 0) continue;
            std::vector<Points> drawn;
            for (std::size_t d = 0; d < uncertainty->draws.size(); ++d) {
                try {
                    const skeleton::Equilibrium found =
                        solver->solve(uncertainty->draws[d], load, {}, &here.equilibrium.state, before_by_draws[d]);
                    before_by_draws[d] = skeleton::flowed(model, found);
                    drawn.push_back(skin_displacement(model, found, load));
                } catch (const SolverFailure&) {
                }
            }
            if (drawn.empty()) continue;
            const double share = share_of_force(load, uncertainty->measured);
            set_spread(drawn, mean_square_error(here.displacement, share, uncertainty->forecast_error), here);
        }
    });
    std::vector<Forecast> all;
    for (std::vector<Forecast>& of_sequence : of_sequences) std::ranges::move(of_sequence, std::back_inserter(all));
    return all;
}

std::vector<std::string> extrapolations(const identify::MeasuredRange& measured,
                                        const std::vector<identify::LoadState>& states,
                                        const std::vector<Forecast>& forecasts, double size) {
    constexpr double more = 1.2;  // times what was measured
    constexpr double far = 0.15;  // from the nearest place that was touched, of the size
    std::vector<int> strong, far_off, wide, unlike;
    for (std::size_t s = 0; s < states.size(); ++s) {
        for (const mesh::Contact& contact : states[s].contacts) {
            if (contact.force.isZero(0)) continue;
            if (measured.places.empty()) {
                unlike.push_back(states[s].probe);
                continue;
            }
            if (contact.force.norm() > more * measured.force) strong.push_back(states[s].probe);
            const bool is_near = std::ranges::any_of(
                measured.places, [&](const Vec3& place) { return (place - contact.point).norm() <= far * size; });
            if (!is_near) far_off.push_back(states[s].probe);
        }
        // Where no marker was read nobody knows how far it moved.
        if (measured.displacement > 0 && forecasts[s].largest > more * measured.displacement)
            wide.push_back(states[s].probe);
    }
    std::vector<std::string> words;
    if (!unlike.empty())
        words.push_back(fmt::format("{}: pressed by a force; the measurements contain none.", probes_in_words(unlike)));
    if (!strong.empty())
        words.push_back(fmt::format("{}: pressed harder than anything that was measured, {:.3g} N at most.",
                                    probes_in_words(strong), measured.force));
    if (!far_off.empty())
        words.push_back(fmt::format("{}: further than {:.3g} mm from any place that was touched in the measurements.",
                                    probes_in_words(far_off), far * size));
    if (!wide.empty())
        words.push_back(fmt::format("{}: moved further than any marker that was measured, {:.3g} mm at most.",
                                    probes_in_words(wide), measured.displacement));
    if (!words.empty()) words.emplace_back("There the model extrapolates, and the intervals may be too narrow.");
    return words;
}

}  // namespace palpate::pipeline
