#include "identify/diagnosis/fit/measured_branch.h"

#include <atomic>
#include <cmath>

#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

// Of the displacement: two equilibria under one tool differ by about as far as it moves the body. The less, the more
// states are sought again in vain.
constexpr double far = 0.2;
constexpr double beyond_noise = 3;   // times sigma: equilibria that differ by less are alike to the readings
constexpr double much_nearer = 0.5;  // of the misfit: another equilibrium, not the same one found again

/// What the markers show in one action.
class MarkersInAction {
public:
    MarkersInAction(const Problem& problem, int k)
        : measured_(Eigen::VectorXd::Zero(3 * Eigen::Index{problem.markers})), count_(measured_), origin_(measured_) {
        double squares = 0;
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            if (problem.action[n] != k || !problem.is_position(n) || problem.is_difference(n)) continue;
            const int c = problem.coordinate[n];
            measured_[c] += problem.measured[n];
            origin_[c] = problem.origin(n);
            squares += problem.sigma[n] * problem.sigma[n];
            ++count_[c];
            ++rows_;
        }
        measured_ = (count_.array() > 0).select(measured_.array() / count_.array().max(1), 0);
        if (rows_ > 0) sigma_ = std::sqrt(squares / rows_);
    }

    /// Measured less modelled, 0 where nothing was read (3m) [mm].
    Eigen::VectorXd error(const Points& read) const {
        const Eigen::VectorXd modelled = read.topRows(measured_.size() / 3).reshaped<Eigen::RowMajor>();
        return (count_.array() > 0).select(measured_ - modelled, 0);
    }
    bool is_far_off(const Eigen::VectorXd& error) const {
        const double noise = sigma_ * std::sqrt(static_cast<double>((count_.array() > 0).count()));
        return error.norm() > far * (measured_ - origin_).norm() && error.norm() > beyond_noise * noise;
    }

private:
    Eigen::VectorXd measured_, count_, origin_;
    int rows_ = 0;
    double sigma_ = 0;
};

/// The step that forces at the markers make where they move these by about `error`: by conjugate gradients, ended
/// before they follow the noise, which would crumple elements.
Eigen::VectorXd step_towards(const Eigen::VectorXd& error, const Tangent& J, const Eigen::SparseMatrix<double>& H) {
    constexpr double left = 0.02;  // of the squared error
    constexpr int most = 30;       // a few shapes make up the way from one equilibrium to another
    Eigen::VectorXd step = Eigen::VectorXd::Zero(H.cols()), residual = error, direction = error;
    double squared = residual.squaredNorm();
    const double enough = left * squared;
    for (int k = 0; k < most && squared > enough; ++k) {
        const Eigen::VectorXd moved = J.solve(H.transpose() * direction), seen = H * moved;
        const double curvature = direction.dot(seen);
        if (!(curvature > 0)) break;
        const double share = squared / curvature;
        step += share * moved;
        residual -= share * seen;
        const double now = residual.squaredNorm();
        direction = residual + now / squared * direction;
        squared = now;
    }
    return step;
}

}  // namespace

std::optional<ForwardSolution> nearer_to_measured(const BodyModel& model, const Problem& problem,
                                                  const Explanation& explanation, const ForwardSolution& forward,
                                                  int threads) {
    const ModelSetting setting = explanation.setting();
    if (setting.effects.remember() || !model.is_nonlinear(setting)) return std::nullopt;
    std::vector<int> off;
    for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) {
        if (problem.actions[k].motions.empty()) continue;
        const MarkersInAction markers(problem, k);
        if (markers.is_far_off(markers.error(forward.markers[k]))) off.push_back(k);
    }
    if (off.empty()) return std::nullopt;
    std::shared_ptr<const Tangent> at_rest;
    try {
        at_rest = model.tangent(model.rest(setting), setting, {});
    } catch (const SolverFailure&) {  // it is the tools that hold the body
        return std::nullopt;
    }
    ForwardSolution nearer = forward;
    std::atomic<bool> is_nearer = false;
    for_each_in_parallel(static_cast<int>(off.size()), threads, [&](int o) {
        const int k = off[o];
        const Action& action = forward.actions[k];
        const MarkersInAction markers(problem, k);
        const Eigen::VectorXd error = markers.error(forward.markers[k]);
        const Eigen::VectorXd step = step_towards(error, *at_rest, model.observation(forward.q[k], setting));
        const Eigen::VectorXd near = model.advance(forward.q[k], step, setting);
        try {
            const Eigen::VectorXd q = model.equilibrium(setting, action, &near);
            const Points channels = channels_of(model, problem, setting, action, q);
            const Points read = explanation.read(problem, channels);
            if (!(markers.error(read).norm() < much_nearer * error.norm())) return;
            nearer.q[k] = q;
            nearer.channels[k] = channels;
            nearer.markers[k] = read;
            is_nearer = true;
        } catch (const SolverFailure&) {  // there is none about there
        }
    });
    if (!is_nearer) return std::nullopt;
    nearer.tangents = std::make_shared<TangentCache>(static_cast<int>(problem.actions.size()));
    return nearer;
}

}  // namespace palpate::identify
