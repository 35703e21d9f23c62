#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "mesh/errors.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/newton.h"
#include "skeleton/statics/skeleton_system.h"
#include "skeleton/statics/statics.h"

namespace palpate::skeleton {

namespace {

Load scaled(Load load, double share) {
    load.gravity *= share;
    load.pressure *= share;
    for (PointForce& force : load.forces) force.force *= share;
    return load;
}

Equilibrium solve_linear(SkeletonSystem& system, const Eigen::VectorXd& k, const Load& load) {
    const State rest = rest_state(system.body());
    system.assemble(k, rest);
    system.factor_stable(k);
    Equilibrium result;
    result.step = system.solve(system.balance(k, rest, load).net);
    result.state = advance(rest, result.step);
    result.iterations = 1;
    Eigen::VectorXd left =
        external_force(system.body(), rest, load) + system.links().linear_forces(result.step, system.before()) * k;
    if (!system.effects().empty()) left += system.effects().linear_force(result.step);
    result.residual = system.largest_force(left);
    return result;
}

// Newton's way to an equilibrium, or why it led to none: "" when it did not come to an end. A link that collapses on
// the way is such a reason, for smaller steps of the load may lead round it.
std::optional<std::string> failure_of_newton(SkeletonSystem& system, const Eigen::VectorXd& k, const Load& load,
                                             const EquilibriumOptions& options, Equilibrium& result) {
    try {
        if (newton(system, k, load, options, result)) return std::nullopt;
        return "";
    } catch (const SolverFailure& failure) {
        return failure.what();
    }
}

// A share of the effects in force, all of them again at its end.
class ScaledEffects {
public:
    explicit ScaledEffects(SkeletonSystem& system) : system_(system) {}
    ~ScaledEffects() { system_.scale_effects(1); }
    ScaledEffects(const ScaledEffects&) = delete;
    ScaledEffects& operator=(const ScaledEffects&) = delete;
    void set(double share) { system_.scale_effects(share); }

private:
    SkeletonSystem& system_;
};

// From the start, a quarter of load and effects at a time, less where that fails. `result` comes from a try with the
// whole load.
void step_load(SkeletonSystem& system, const Eigen::VectorXd& k, const Load& load, const EquilibriumOptions& options,
               Equilibrium& result) {
    const double left = result.residual;
    Equilibrium reached = result;
    reached.state = system.start();
    ScaledEffects effects(system);
    for (double share = 0, more = 0.25; share < 1;) {
        result = reached;
        effects.set(share + more);
        const auto failure = failure_of_newton(system, k, scaled(load, share + more), options, result);
        if (!failure) {
            reached = result;
            share += more;
            more = std::min(2 * more, 1 - share);
            continue;
        }
        reached.iterations = result.iterations;
        more /= 2;
        if (more >= 1.0 / 128) continue;
        if (!failure->empty()) throw SolverFailure(*failure);
        throw SolverFailure(fmt::format(
            "no equilibrium found in {} Newton steps: at the whole load {:.3g} N were left, {:.0f} % of it were "
            "reached by load stepping; lower the forces or raise the stiffness",
            reached.iterations, left, 100 * share));
    }
}

// From rest to a state (6N).
Eigen::VectorXd step_to(const Model& model, const State& state) {
    Eigen::VectorXd step(model.dofs());
    for (size_t i = 0; i < model.spheres.size(); ++i) {
        step.segment<3>(6 * i) = state.x.row(i).transpose() - model.spheres[i].center;
        step.segment<3>(6 * i + 3) = rotation_vector(state.R[i]);
    }
    return step;
}

}  // namespace

struct StaticsSolver::Impl {
    SkeletonSystem system;
};

StaticsSolver::StaticsSolver(const Model& model, const fem::Effects& extra)
    : impl_(new Impl{SkeletonSystem(model, physics_of(model.effects, extra))}) {}
StaticsSolver::~StaticsSolver() = default;
StaticsSolver::StaticsSolver(StaticsSolver&&) noexcept = default;
StaticsSolver& StaticsSolver::operator=(StaticsSolver&&) noexcept = default;

void StaticsSolver::expect(const std::vector<Load>& loads) {
    for (const Load& load : loads) impl_->system.prepare(load);
}

Equilibrium StaticsSolver::solve(const Eigen::VectorXd& k, const Load& load, const EquilibriumOptions& options,
                                 const State* start, const FibreStates& before) {
    options.validate();
    SkeletonSystem& system = impl_->system;
    system.remember(before);
    Equilibrium result;
    if (system.body().law == EquilibriumLaw::linear) {
        result = solve_linear(system, k, load);
    } else {
        result.state = start ? *start : system.start();
        if (failure_of_newton(system, k, load, options, result)) step_load(system, k, load, options, result);
        result.step = step_to(system.body(), result.state);
    }
    result.before = before;
    return result;
}

Eigen::MatrixXd StaticsSolver::linear_steps(const Eigen::VectorXd& k, const Eigen::MatrixXd& F) {
    impl_->system.remember({});
    impl_->system.assemble_unstrained(k);
    impl_->system.factor_stable(k);
    return impl_->system.solve(F);
}

void StaticsSolver::factor_tangent(const Eigen::VectorXd& k, const Load& load, const Equilibrium& equilibrium) {
    impl_->system.remember(equilibrium.before);
    if (impl_->system.body().law == EquilibriumLaw::linear)
        impl_->system.assemble(k, rest_state(impl_->system.body()));
    else
        impl_->system.assemble(k, equilibrium.state, &load);
    impl_->system.factor_stable(k);
}

Eigen::MatrixXd StaticsSolver::solve_tangent(const Eigen::MatrixXd& B) const { return impl_->system.solve(B); }

}  // namespace palpate::skeleton
