#include "identify/models/free_tools.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

#include "mesh/errors.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

constexpr double tolerance = 1e-8;  // of what tools exert in all
constexpr double nothing = 1e-12;   // of the body's size: a step that rounding makes of stiff springs' forces
constexpr int most_steps = 40;      // Newton's method needs a few: by then it wanders
constexpr int halvings = 12;        // to a four-thousandth of a step: nothing falls along it

/// d turn / d w: how the turn in space follows the rotation vector w.
Mat3 turn_by_vector(const Vec3& w) {
    const double angle = w.norm();
    if (angle < 1e-6) return Mat3::Identity() + skeleton::skew(w) / 2;
    const Mat3 W = skeleton::skew(w / angle);
    return Mat3::Identity() + (1 - std::cos(angle)) / angle * W + (1 - std::sin(angle) / angle) * W * W;
}

/// Which coordinates are free, and where tools are with those at some value.
class FreeCoordinates {
public:
    explicit FreeCoordinates(const Action& action) : action_(action) {
        for (std::size_t t = 0; t < action.motions.size(); ++t) {
            for (int c = 0; c < 6; ++c)
                if (std::isnan(coordinate(action_, t, c))) places_.push_back({t, c});
        }
    }

    Eigen::Index count() const { return std::ssize(places_); }
    Action at(const Eigen::VectorXd& z) const {
        Action result = action_;
        for (std::size_t f = 0; f < places_.size(); ++f)
            coordinate(result, places_[f].tool, places_[f].component) = z[static_cast<Eigen::Index>(f)];
        return result;
    }
    /// D: the directions (6t x f).
    Eigen::MatrixXd directions(const Action& posed) const {
        Eigen::MatrixXd D = Eigen::MatrixXd::Zero(6 * std::ssize(posed.motions), count());
        for (std::size_t f = 0; f < places_.size(); ++f) {
            const auto& [tool, component] = places_[f];
            const auto row = static_cast<Eigen::Index>(6 * tool), column = static_cast<Eigen::Index>(f);
            if (component < 3)
                D(row + component, column) = 1;
            else
                D.block<3, 1>(row + 3, column) = turn_by_vector(posed.motions[tool].rotation).col(component - 3);
        }
        return D;
    }
    /// The share of a step that is taken: no translation goes by more than a fifth of the body's size, so that a tool
    /// does not leap past what it touches.
    static double limit(const Eigen::VectorXd& step, double size) {
        return std::min(1.0, 0.2 * size / std::max(step.cwiseAbs().maxCoeff(), 1e-300));
    }

private:
    struct Place {
        std::size_t tool;
        int component;
    };
    static double& coordinate(Action& action, std::size_t tool, int component) {
        mesh::ToolMotion& motion = action.motions[tool];
        return component < 3 ? motion.translation[component] : motion.rotation[component - 3];
    }

    Action action_;
    std::vector<Place> places_;
};

/// A^-1 b but for directions in which A is nothing.
Eigen::MatrixXd solve_resisted(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
    decomposition.setThreshold(1e-10);  // of the largest pivot: a choice above rounding
    decomposition.compute(A);
    return decomposition.solve(b);
}

/// Newton's method to where `forces`, along free coordinates, vanish; `step` is its step there.
template <class Forces, class Step>
bool find_zero(const Forces& forces, const Step& step, double size, Eigen::VectorXd& z) {
    auto [f, enough] = forces(z);
    for (int k = 0; k < most_steps && f.norm() > enough; ++k) {
        const Eigen::VectorXd whole = step(z);
        if (whole.cwiseAbs().maxCoeff() <= nothing * size) return true;
        double share = FreeCoordinates::limit(whole, size);
        for (int halving = 0;; ++halving, share /= 2) {
            if (halving == halvings) return false;
            const Eigen::VectorXd trial = z + share * whole;
            const auto [there, enough_there] = forces(trial);
            if (!(there.norm() < f.norm() || there.norm() <= enough_there)) continue;
            z = trial, f = there, enough = enough_there;
            break;
        }
    }
    return f.norm() <= enough;
}

[[noreturn]] void fail() {
    throw SolverFailure(
        "The free coordinates of a tool come to no rest: no place was found where nothing pushes it along them. Impose "
        "them, by 0 in motions.csv, or check that the tool is in touch with the body.");
}

/// All that is made of the free coordinates in one configuration.
struct FreeSystem {
    Action action;  // posed
    Eigen::MatrixXd D;
    ReactionSlopes slopes;
    Eigen::MatrixXd C, P;  // M D and D^T Z D

    FreeSystem(const BodyModel& model, const Eigen::VectorXd& q, const ModelSetting& setting, const Action& free)
        : action(posed(model, q, setting, free)),
          D(FreeCoordinates(free).directions(action)),
          slopes(model.reaction_slopes(q, setting, action)),
          C(slopes.by_step.transpose() * D),
          P(D.transpose() * slopes.by_pose * D) {}
};

class FreeTangent : public Tangent {
public:
    FreeTangent(std::shared_ptr<const Tangent> fixed, const FreeSystem& system)
        : fixed_(std::move(fixed)), C_(system.C), Y_(fixed_->solve(C_)), S_(system.P - C_.transpose() * Y_) {}
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override {
        const Eigen::MatrixXd X = fixed_->solve(B);
        return X + Y_ * solve_resisted(S_, C_.transpose() * X);
    }
    double gigabytes() const override { return fixed_->gigabytes(); }

private:
    std::shared_ptr<const Tangent> fixed_;
    Eigen::MatrixXd C_, Y_, S_;
};

}  // namespace

bool has_free_coordinates(const Action& action) {
    return std::ranges::any_of(action.motions, [](const mesh::ToolMotion& motion) {
        return motion.translation.hasNaN() || motion.rotation.hasNaN();
    });
}

Action posed(const BodyModel& model, const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action) {
    if (!has_free_coordinates(action)) return action;
    const FreeCoordinates free(action);
    const auto forces = [&](const Eigen::VectorXd& z) {
        const Action at = free.at(z);
        const Eigen::VectorXd W = model.reactions(q, setting, at);
        return std::pair<Eigen::VectorXd, double>(free.directions(at).transpose() * W, tolerance * W.norm());
    };
    const auto step = [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
        const Action at = free.at(z);
        const Eigen::MatrixXd D = free.directions(at);
        const Eigen::VectorXd f = D.transpose() * model.reactions(q, setting, at);
        return -solve_resisted(D.transpose() * model.reaction_slopes(q, setting, at).by_pose * D, f);
    };
    Eigen::VectorXd z = Eigen::VectorXd::Zero(free.count());
    if (!find_zero(forces, step, model.size(), z)) fail();
    return free.at(z);
}

Eigen::VectorXd equilibrium_with_free_tools(const BodyModel& model, const ModelSetting& setting, const Action& action,
                                            const Eigen::VectorXd* start, const Tangent* guide) {
    const FreeCoordinates free(action);
    std::optional<Eigen::VectorXd> near;
    if (start) near = *start;
    Eigen::VectorXd q, at_z;
    const auto settle = [&](const Eigen::VectorXd& z) {
        if (at_z.size() == z.size() && at_z == z) return;
        q = model.equilibrium(setting, free.at(z), near ? &*near : nullptr, guide);
        near = q;
        at_z = z;
    };
    const auto forces = [&](const Eigen::VectorXd& z) {
        settle(z);
        const Eigen::VectorXd W = model.reactions(q, setting, free.at(z));
        // Equilibria are known to a ten-millionth of forces.
        return std::pair<Eigen::VectorXd, double>(free.directions(free.at(z)).transpose() * W, 1e-6 * W.norm());
    };
    const auto step = [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
        settle(z);
        const Action at = free.at(z);
        const Eigen::MatrixXd D = free.directions(at);
        const ReactionSlopes slopes = model.reaction_slopes(q, setting, at);
        const Eigen::MatrixXd C = slopes.by_step.transpose() * D;
        const Eigen::MatrixXd S =
            D.transpose() * slopes.by_pose * D - C.transpose() * model.tangent(q, setting, at)->solve(C);
        return -solve_resisted(S, D.transpose() * model.reactions(q, setting, at));
    };
    Eigen::VectorXd z = Eigen::VectorXd::Zero(free.count());
    if (!find_zero(forces, step, model.size(), z)) fail();
    settle(z);
    return q;
}

std::shared_ptr<const Tangent> tangent_with_free_tools(const BodyModel& model, const Eigen::VectorXd& q,
                                                       const ModelSetting& setting, const Action& action) {
    const FreeSystem system(model, q, setting, action);
    return std::make_shared<FreeTangent>(model.tangent(q, setting, system.action), system);
}

Eigen::MatrixXd tangent_times_with_free_tools(const BodyModel& model, const Eigen::VectorXd& q,
                                              const ModelSetting& setting, const Action& action,
                                              const Eigen::MatrixXd& steps) {
    const FreeSystem system(model, q, setting, action);
    return model.tangent_times(q, setting, system.action, steps) -
           system.C * solve_resisted(system.P, system.C.transpose() * steps);
}

ReactionSlopes reaction_slopes_with_free_tools(const BodyModel& model, const Eigen::VectorXd& q,
                                               const ModelSetting& setting, const Action& action) {
    FreeSystem system(model, q, setting, action);
    // The free coordinates follow: dz = -P^-1 D^T dW.
    const auto followed = [&](const Eigen::MatrixXd& dW) -> Eigen::MatrixXd {
        return dW - system.slopes.by_pose * system.D * solve_resisted(system.P, system.D.transpose() * dW);
    };
    ReactionSlopes slopes = system.slopes;
    slopes.by_step = followed(system.slopes.by_step);
    slopes.by_pose = followed(system.slopes.by_pose);
    return slopes;
}

}  // namespace palpate::identify
