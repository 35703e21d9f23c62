#include "identify/diagnosis/verdict/next_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "identify/diagnosis/verdict/trials.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"
#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// How far two explanations are apart in a trial.
struct Distance {
    double sigmas = 0;  // root of the sum of squares over all markers, on average over the states that are read
    double rms_mm = 0;
};

class Separation {
public:
    Separation(const BodyModel& model, const Problem& problem, const std::vector<const FittedExplanation*>& alike,
               const RefitOptions& options)
        : model_(model), problem_(problem), alike_(alike), options_(options), sigma_(problem.rms_sigma()) {
        options_.threads = 1;  // trials run side by side
    }

    /// How far apart a trial would move the markers under the pair that it tells apart least [mm]; quick.
    double least_moved(const CandidateProbe& trial) const {
        if (trial.states.empty()) return least(trial).rms_mm;
        std::vector<Eigen::VectorXd> moved;
        try {
            const Problem problem = problem_of(trial);
            for (const FittedExplanation* one : alike_) {
                const HeldOutPrediction there = predict_response(model_, problem, in(trial, one->fit), options_);
                moved.push_back(there.problem.pick(there.forward.markers));
            }
        } catch (const SolverFailure&) {
            return 0;
        }
        double least = INFINITY;
        for (std::size_t i = 0; i < moved.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) least = std::min(least, (moved[i] - moved[j]).norm());
        }
        return least;
    }

    /// The pair that a trial tells apart least.
    Distance least(const CandidateProbe& trial) const {
        Distance least{INFINITY, INFINITY};
        for (std::size_t i = 0; i < alike_.size(); ++i) {
            for (std::size_t j = 0; j < alike_.size(); ++j) {
                if (i == j) continue;
                const Distance pair = apart(trial, *alike_[i], *alike_[j]);
                if (pair.sigmas < least.sigmas) least = pair;
            }
        }
        return least;
    }

private:
    /// As if the other were true, and this one foretold it.
    Distance apart(const CandidateProbe& trial, const FittedExplanation& one, const FittedExplanation& other) const {
        if (trial.states.empty()) return apart_at_rest(one.fit, other.fit);
        try {
            Problem problem = problem_of(trial);
            const HeldOutPrediction truth = predict_response(model_, problem, in(trial, other.fit), options_);
            problem.measured = truth.problem.pick(truth.forward.markers);
            const HeldOut error = predict(model_, problem, in(trial, one.fit), options_);
            const auto read = static_cast<double>(problem.rows()) / static_cast<double>(trial.states.size());
            return {error.whitened_rms * std::sqrt(read), error.rms_mm};
        } catch (const SolverFailure&) {
            return {};
        }
    }

    /// Points that stand still, as the two see them.
    Distance apart_at_rest(const Refit& one, const Refit& other) const {
        const Points& support = model_.support_points();
        if (support.rows() == 0) return {};
        constexpr int fiducials = 4;  // three fix a frame, one more checks them
        const Points points = support(mesh::farthest_points(support, fiducials), Eigen::all);
        const auto seen = [&](const Explanation& explanation) {
            const Points at = explanation.see(problem_, points);
            return Eigen::VectorXd(at.reshaped() / sigma_);
        };
        const Eigen::VectorXd own = seen(one.explanation), d = seen(other.explanation) - own;
        // what the fit leaves open
        const Eigen::MatrixXd spread = one.covariance.llt().matrixL();
        Eigen::MatrixXd A(d.size(), spread.cols());
        for (Eigen::Index c = 0; c < spread.cols(); ++c) {
            Explanation moved = one.explanation;
            moved.set_all(moved.all() + spread.col(c));
            A.col(c) = seen(moved) - own;
        }
        const Whitening V(Eigen::VectorXd::Ones(d.size()), A, Eigen::VectorXd::Ones(A.cols()));
        return {std::sqrt(V.chi_square(d)), sigma_ * d.norm() / std::sqrt(static_cast<double>(d.size()))};
    }

    /// What is read in a trial: all markers, in every state.
    Problem problem_of(const CandidateProbe& trial) const {
        MeasurementSet set;
        const Points markers = problem_.rest.topRows(problem_.markers);
        for (const auto& rest : markers.rowwise()) {
            set.markers.push_back({static_cast<int>(set.markers.size()), rest.transpose(), {}});
        }
        set.tools = problem_.rig->tools;
        set.actuators = problem_.rig->actuators;
        set.states = trial.states;
        for (LoadState& state : set.states) {
            for (const Marker& marker : set.markers) state.readings.push_back({marker.id, marker.rest});
        }
        return make_problem(set, sigma_).stage_by_stage();
    }

    static Refit in(const CandidateProbe& trial, const Refit& fit) {
        Refit result = fit;
        Explanation& all = result.explanation;
        for (std::size_t e = 0; e < all.effects.size(); ++e) {
            all.values[e] = all.effects[e]->under(trial.conditions, all.values[e]);
        }
        return result;
    }

    const BodyModel& model_;
    const Problem& problem_;
    const std::vector<const FittedExplanation*>& alike_;
    RefitOptions options_;
    double sigma_;
};

/// The effect that one has and another has not.
const EffectHypothesis& own_effect(const FittedExplanation& of, const FittedExplanation& other) {
    const auto found = std::ranges::find_if(of.effects, [&](const auto& effect) { return !other.has(effect->name()); });
    return found == of.effects.end() ? *of.effects.front() : **found;
}

/// Trials of each kind under which the markers move furthest apart, a few of a kind.
std::vector<int> best_of_each_kind(const std::vector<CandidateProbe>& all, const std::vector<double>& moved) {
    std::vector<int> order(all.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater{}, [&](int i) { return moved[i]; });
    std::map<std::string, int> taken;
    constexpr int most = 3;  // each is played with its nuisances under every pair of explanations, which takes longest
    std::erase_if(order, [&](int i) { return ++taken[all[i].probe.kind] > most; });
    return order;
}

}  // namespace

NextProbe separate(const BodyModel& model, const Problem& problem, const std::vector<const FittedExplanation*>& alike,
                   const RefitOptions& options) {
    const std::vector<CandidateProbe> all = candidate_probes(model, problem);
    const Separation separation(model, problem, alike, options);
    std::vector<double> moved(all.size());
    for_each_in_parallel(static_cast<int>(all.size()), options.threads,
                         [&](int i) { moved[i] = separation.least_moved(all[i]); });
    const std::vector<int> promising = best_of_each_kind(all, moved);
    std::vector<Distance> apart(all.size());
    for_each_in_parallel(static_cast<int>(promising.size()), options.threads,
                         [&](int i) { apart[promising[i]] = separation.least(all[promising[i]]); });

    const EffectHypothesis &one = own_effect(*alike[0], *alike[1]), &other = own_effect(*alike[1], *alike[0]);
    const std::string separates = fmt::format("separates {} from {}", one.name(), other.name());
    const auto best = std::ranges::max_element(apart, {}, &Distance::sigmas) - apart.begin();
    constexpr double tells = 3;  // sigmas, the usual bound of what is told apart
    if (!(apart[best].sigmas > tells)) {
        return {.kind = one.description().next_probe,
                .why = fmt::format("{}: {}", separates, one.description().separating_probe)};
    }
    NextProbe result = all[best].probe;
    result.sigmas = apart[best].sigmas;
    result.rms_mm = apart[best].rms_mm;
    result.why =
        fmt::format("{}: {}; their predictions would differ by {:.2g} mm rms there, {:.3g} times the uncertainty",
                    separates, all[best].asks, result.rms_mm, result.sigmas);
    return result;
}

}  // namespace palpate::identify
