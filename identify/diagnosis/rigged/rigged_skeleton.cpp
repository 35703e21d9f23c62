#include "identify/diagnosis/rigged/rigged_skeleton.h"

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/search/baselines.h"
#include "identify/effects/catalogue.h"
#include "identify/inference/posterior.h"
#include "identify/inference/problem/parameters.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "identify/numerics/random.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

/// For how deep a contact may dent [MPa], where the set has no guess.
constexpr double start_young = 0.1;

/// Of each kind of stiffness about the common factor, as of other sets.
const double prior_sd = std::log(3.0);

SkeletonBody body_of(const skeleton::Model& model, const MeasurementSet& set,
                     const std::vector<InformativePrior>& priors = {}) {
    const bool is_told = set.material && set.material->young > 0;
    return {model,    set.markers, is_told ? set.material->young : start_young, Rig{set.tools, set.actuators},
            prior_sd, priors};
}

constexpr int large_rotation = 1;  // law

/// The only law that knows tools which may part from the body; none: both do.
std::optional<int> only_law(const MeasurementSet& set) {
    const bool parts = std::ranges::any_of(set.states, [&](const LoadState& state) {
        return std::ranges::any_of(state.motions,
                                   [&](const mesh::ToolMotion& motion) { return !set.tools[motion.tool].bonded; });
    });
    return parts ? std::optional(large_rotation) : std::nullopt;
}

/// The model with all stiffnesses scaled alike, so that it answers about as it was measured: kinds of stiffness that
/// nothing informs go with the others then.
skeleton::Model scaled(const skeleton::Model& model, const MeasurementSet& set, const Problem& problem, int threads) {
    const SkeletonBody body = body_of(model, set);
    skeleton::Model result = model;
    skeleton::set_stiffness(result, body.stiffness(first_guess(body, problem, large_rotation, threads).setting()));
    return result;
}

/// What a fit leaves of positions, forces and moments counts as their noise from then on: a coarse skeleton errs by
/// more than sensors do, and would bend its stiffness far for the difference.
void add_model_error(const Refit& fit, Problem& problem) {
    const auto kind_of = [&](Eigen::Index n) {
        return problem.is_position(n) ? 0 : 1 + (problem.channel(n) - problem.markers) % 2;
    };
    Eigen::Array3d squares = Eigen::Array3d::Zero(), counts = Eigen::Array3d::Zero();
    const Eigen::VectorXd error = fit.error.cwiseProduct(problem.sigma);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        squares[kind_of(n)] += error[n] * error[n];
        counts[kind_of(n)] += 1;
    }
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int kind = kind_of(n);
        problem.sigma[n] = std::hypot(problem.sigma[n], std::sqrt(squares[kind] / counts[kind]));
    }
}

/// Of the parameters of a uniform fit, in their order, out of those of the body.
std::vector<Eigen::Index> places_of(const Parameters& parameters, const SkeletonBody& body) {
    std::vector<Eigen::Index> places;
    for (const Parameter& parameter : parameters.list) {
        const auto own = std::ranges::find(body.parameters(), parameter.name, &StiffnessParameter::name);
        places.push_back(own - body.parameters().begin());
    }
    return places;
}

/// Draws from Laplace's approximation of a fit's stiffness.
TemperedResult draws_of(const Refit& fit, const std::vector<Eigen::Index>& places, int particles, std::uint64_t seed) {
    const auto P = std::ssize(places);
    const Eigen::VectorXd mean = fit.explanation.theta(places);
    const Eigen::LLT<Eigen::MatrixXd> spread(fit.covariance(places, places));
    RandomStream random(seed, 0, 0);
    TemperedResult draws;
    draws.particles.resize(particles, P);
    draws.log_density.resize(particles);
    for (int i = 0; i < particles; ++i) {
        const Eigen::VectorXd v = random.normals(static_cast<int>(P));
        draws.particles.row(i) = (mean + spread.matrixL() * v).transpose();
        draws.log_density[i] = -0.5 * v.squaredNorm();
    }
    draws.log_weights = Eigen::VectorXd::Constant(particles, -std::log(particles));
    draws.mode.assign(static_cast<std::size_t>(particles), 0);
    draws.independent = particles;
    draws.log_evidence = fit.log_evidence;
    draws.history.push_back({1, static_cast<double>(particles), draws.particles, draws.log_weights});
    return draws;
}

}  // namespace

bool is_rigged(const MeasurementSet& set) {
    return std::ranges::any_of(set.states, [](const LoadState& state) {
        return !state.motions.empty() || !state.actuations.empty() ||
               std::ranges::any_of(state.readings, [](const Reading& reading) { return reading.since.has_value(); });
    });
}

IdentifyResult identify_rigged(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& how,
                               const Progress& progress) {
    constexpr int draws_by_default = 200;  // as of the tempered filter
    Problem problem = make_problem(set);
    const skeleton::Model start = scaled(model, set, problem, how.threads);
    const SkeletonBody body = body_of(start, set, how.priors);
    DiagnoseOptions options;
    options.known = model.effects;
    options.refit.threads = how.threads;
    options.refit.correct_for_mesh = false;
    options.law = only_law(set);
    IdentifyResult result;
    Baselines baselines(body, options);
    baselines.fit(problem, result.notes, progress);
    add_model_error(baselines.best(), problem);
    baselines.refit(problem);
    const Refit& fit = baselines.best();

    result.model = start;
    result.model.law = static_cast<skeleton::EquilibriumLaw>(fit.explanation.law);
    skeleton::set_stiffness(result.model, body.stiffness(fit.explanation.setting()));
    result.model.effects.clear();
    for (std::size_t e = 0; e < fit.explanation.effects.size(); ++e) {
        result.model.effects.push_back(fit.explanation.effects[e]->record(fit.numbers[e], fit.explanation.values[e]));
    }
    const Parameters parameters = group_stiffness(start, Scope::uniform);
    const std::vector<Eigen::Index> places = places_of(parameters, body);
    TemperedResult draws = draws_of(fit, places, how.particles > 0 ? how.particles : draws_by_default, how.seed);
    const LogNormalPrior prior{fit.prior_mean(places), fit.prior_sd(places), nullptr};
    report_particles(parameters, prior, {fit.explanation.theta(places)}, draws, result);
    result.states = static_cast<int>(set.states.size());
    result.coordinates = static_cast<int>(problem.rows());
    result.notes.emplace_back(
        "Sets with tools, actuators or displacements since a loaded state: one multiplier was fitted for each kind of "
        "stiffness.");
    return result;
}

namespace {

/// The model with its own effects, none of them a fault of the measurement.
Explanation as_it_is(const skeleton::Model& model, const SkeletonBody& body, const Problem& problem) {
    Explanation explanation{.law = static_cast<int>(model.law),
                            .theta = Eigen::VectorXd::Zero(std::ssize(body.parameters())),
                            .effects = {},
                            .values = {}};
    for (const skeleton::EffectRecord& known : model.effects) {
        const auto effect = find_effect(known.name);
        const auto numbers = effect->numbers(body, problem);
        if (numbers.empty() || !effect->is_of_body()) continue;
        explanation.effects.push_back(effect);
        explanation.values.push_back(effect->values(numbers, known));
    }
    return explanation;
}

}  // namespace

std::vector<skeleton::Equilibrium> play_rigged(const skeleton::Model& model, const MeasurementSet& set, int threads) {
    const SkeletonBody body = body_of(model, set);
    const Problem problem = make_problem(set).stage_by_stage();  // states that nobody reads, too
    const Explanation explanation = as_it_is(model, body, problem);
    const ForwardSolution forward = solve_forward(body, problem, explanation, threads);
    std::vector<skeleton::Equilibrium> played;
    played.reserve(forward.q.size());
    for (const Eigen::VectorXd& q : forward.q) played.push_back(body.equilibrium_at(q, explanation.setting()));
    return played;
}

RiggedPrediction predict_rigged(const skeleton::Model& model, const MeasurementSet& set, int threads) {
    const SkeletonBody body = body_of(model, set);
    const Problem problem = make_problem(set);
    const Explanation explanation = as_it_is(model, body, problem);
    const Problem asked = explanation.has_memory() && !problem.by_stage ? problem.stage_by_stage() : problem;
    const ForwardSolution forward = solve_forward(body, asked, explanation, threads);
    std::vector<int> action(set.states.size(), -1), since = action;
    for (Eigen::Index n = 0; n < asked.rows(); ++n) {
        action[asked.state[n]] = asked.action[n];
        if (asked.is_difference(n)) since[asked.since_state[n]] = asked.since[n];
    }
    RiggedPrediction predicted;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const std::vector<Reading>& readings = set.states[s].readings;
        Points own = Points::Constant(std::ssize(readings), 3, missing);
        for (std::size_t r = 0; r < readings.size() && action[s] >= 0; ++r) {
            if (readings[r].marker < 0) continue;
            own.row(static_cast<Eigen::Index>(r)) = forward.markers[action[s]].row(readings[r].marker);
            if (!readings[r].since) continue;
            const auto from = find_state(set, *readings[r].since) - set.states.data();
            own.row(static_cast<Eigen::Index>(r)) +=
                set.markers[readings[r].marker].rest.transpose() - forward.markers[since[from]].row(readings[r].marker);
        }
        predicted.positions.push_back(std::move(own));
        const std::vector<ReactionReading>& reactions = set.states[s].reactions;
        Points felt = Points::Constant(2 * std::ssize(reactions), 3, missing);
        for (std::size_t r = 0; r < reactions.size() && action[s] >= 0; ++r)
            felt.middleRows<2>(2 * static_cast<Eigen::Index>(r)) =
                forward.markers[action[s]].middleRows<2>(problem.markers + 2 * reactions[r].tool);
        predicted.reactions.push_back(std::move(felt));
    }
    return predicted;
}

}  // namespace palpate::identify
