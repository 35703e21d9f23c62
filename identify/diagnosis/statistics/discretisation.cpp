#include "identify/diagnosis/statistics/discretisation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Under which tolerance, rms over sigma, the error may be scaled from a larger load of the same kind: that it is not
/// in proportion to the displacement alters it by a tenth or so, which is nothing next to noise then.
constexpr double small_for_noise = 1;

/// Do the same contacts press along the same lines, by more or less, on a body that remembers nothing and that neither
/// tools nor actuators load?
bool press_alike(const Action& a, const Action& b) {
    const auto is_pressed_alone = [](const Action& one) {
        return !one.memory && one.motions.empty() && one.settings.empty();
    };
    return is_pressed_alone(a) && is_pressed_alone(b) && a.pressure == b.pressure && a.gravity == b.gravity &&
           std::ranges::equal(a.contacts, b.contacts, [](const mesh::Contact& x, const mesh::Contact& y) {
               constexpr double aligned = 0.999;  // cosine: within 2.6 degrees
               return x.point == y.point && x.radius == y.radius &&
                      x.force.dot(y.force) > aligned * x.force.norm() * y.force.norm();
           });
}

/// For each action the one with the largest load of its kind, often itself.
std::vector<int> largest_alike(const std::vector<Action>& actions) {
    std::vector<int> largest(actions.size());
    for (std::size_t k = 0; k < actions.size(); ++k) {
        largest[k] = static_cast<int>(k);
        for (std::size_t j = 0; j < actions.size(); ++j) {
            if (sizes_of(actions[j]).force > sizes_of(actions[largest[k]]).force && press_alike(actions[j], actions[k]))
                largest[k] = static_cast<int>(j);
        }
    }
    return largest;
}

/// Errors of the mesh in an explanation's equilibria, as the markers are seen.
class MeshErrors {
public:
    MeshErrors(const BodyModel& model, const Problem& problem, const Explanation& explanation,
               const ForwardSolution& forward, int threads)
        : model_(model),
          problem_(problem),
          explanation_(explanation),
          forward_(forward),
          threads_(threads),
          seen_(problem.actions.size()),
          is_worth_(problem.actions.size(), problem.discretisation.size() == 0) {
        // What could not be told with other numbers, or is none as nothing acts, is not tried again: it takes longest.
        for (Eigen::Index n = 0; n < problem.discretisation.size(); ++n)
            if (problem.discretisation[n] != 0) is_worth_[problem.action[n]] = 1;
        // But under a tool: with these numbers the body may stand in an equilibrium that a finer mesh has, too.
        for (std::size_t k = 0; k < problem.actions.size(); ++k)
            if (!problem.actions[k].motions.empty()) is_worth_[k] = 1;
    }

    void compute(const std::vector<int>& actions) {
        const ModelSetting setting = explanation_.setting();
        for_each_in_parallel(static_cast<int>(actions.size()), threads_, [&](int i) {
            const int k = actions[i];
            if (!is_worth_[k]) return;
            const Action& action = forward_.actions[k];
            try {
                const auto tangent = model_.tangent(forward_.q[k], setting, action);
                const auto error = model_.discretisation_error(forward_.q[k], setting, action, *tangent);
                if (error) seen_[k] = seen_with(k, *error);
            } catch (const SolverFailure&) {  // on the verge of buckling: not told
            }
        });
    }

    /// What an error alters in the channels as they are read.
    Points seen_with(int k, const MeshError& error) const {
        Points channels = forward_.channels[k];
        channels.topRows(problem_.markers) += error.markers;
        const std::vector<mesh::ToolMotion>& motions = forward_.actions[k].motions;
        for (std::size_t t = 0; t < motions.size(); ++t) {
            const Eigen::Index force = problem_.markers + 2 * motions[t].tool;
            channels.row(force) += error.reactions.segment<3>(static_cast<Eigen::Index>(6 * t));
            channels.row(force + 1) += error.reactions.segment<3>(static_cast<Eigen::Index>(6 * t) + 3);
        }
        return explanation_.read(problem_, channels) - forward_.markers[k];
    }

    /// In proportion to that of another action, by how far the markers move.
    void scale(int k, int from) {
        if (!seen_[from]) return;
        const auto moved = [&](int of) -> Points {
            return (forward_.channels[of] - problem_.rest).topRows(problem_.markers);
        };
        const Points own = moved(k), other = moved(from);
        seen_[k] = own.cwiseProduct(other).sum() / other.squaredNorm() * *seen_[from];
    }

    bool is_told() const {
        return std::ranges::any_of(seen_, [](const auto& one) { return one.has_value(); });
    }

    /// (N) [mm]
    Eigen::VectorXd in_rows() const {
        Eigen::VectorXd result = problem_.discretisation;
        if (result.size() == 0) result.setZero(problem_.rows());
        for (Eigen::Index n = 0; n < problem_.rows(); ++n) {
            const auto& own = seen_[problem_.action[n]];
            if (!own) continue;
            result[n] = (*own)(problem_.channel(n), problem_.coordinate[n] % 3);
            if (!problem_.is_difference(n) || !seen_[problem_.since[n]]) continue;
            result[n] -= (*seen_[problem_.since[n]])(problem_.channel(n), problem_.coordinate[n] % 3);
        }
        return result;
    }

private:
    const BodyModel& model_;
    const Problem& problem_;
    const Explanation& explanation_;
    const ForwardSolution& forward_;
    int threads_;
    std::vector<std::optional<Points>> seen_;  // by how much the markers are seen elsewhere (K of m x 3) [mm]
    std::vector<char> is_worth_;
};

}  // namespace

Eigen::VectorXd discretisation_error(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                     const ForwardSolution& forward, int threads) {
    const std::vector<int> largest = largest_alike(forward.actions);
    std::vector<int> large, smaller;
    for (int k = 0; k < static_cast<int>(largest.size()); ++k) (largest[k] == k ? large : smaller).push_back(k);
    MeshErrors errors(model, problem, explanation, forward, threads);
    errors.compute(large);
    if (!errors.is_told()) return problem.discretisation;
    for (const int k : smaller) errors.scale(k, largest[k]);
    const Eigen::VectorXd scaled = errors.in_rows();
    const double size = scaled.cwiseQuotient(problem.sigma).norm() / std::sqrt(static_cast<double>(problem.rows()));
    if (size < small_for_noise) return scaled;
    errors.compute(smaller);
    return errors.in_rows();
}

Eigen::VectorXd discretisation_of(const Problem& known, const Problem& problem) {
    if (known.discretisation.size() == 0) return {};
    std::map<std::array<int, 3>, double> errors;  // of actions, those that they count from, and coordinates
    for (Eigen::Index n = 0; n < known.rows(); ++n)
        errors[{known.action[n], known.since[n], known.coordinate[n]}] = known.discretisation[n];
    std::vector<int> like(problem.actions.size());
    for (int k = 0; k < static_cast<int>(like.size()); ++k) like[k] = problem.action_in(known, k);
    Eigen::VectorXd result(problem.rows());
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int since = problem.is_difference(n) ? like[problem.since[n]] : -1;
        const auto found = errors.find({like[problem.action[n]], since, problem.coordinate[n]});
        if (found == errors.end()) return {};
        result[n] = found->second;
    }
    return result;
}

}  // namespace palpate::identify
