// Where a body is, and its steps in time.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "skeleton/model/state.h"
#include "skeleton/runtime/body_impl.h"
#include "skeleton/runtime/kernels/motion.h"

namespace palpate::runtime {

void Body::Impl::require_masses() const {
    if (massless < 0) return;
    throw InvalidInput(fmt::format(
        "sphere {} moves and has no mass, or no inertia; motion needs one: give it a 'mass' above 0", massless));
}

void Body::Impl::require_time(double h) const {
    if (!(h > 0) || !std::isfinite(h)) throw InvalidInput(fmt::format("the step is {} s; it must be above 0", h));
    require_masses();
}

int Body::Impl::row(int sphere) const {
    if (sphere < 0 || sphere >= static_cast<int>(reordered.place.size()))
        throw InvalidInput(fmt::format("sphere {} does not exist; spheres are numbered from 0 to {}", sphere,
                                       reordered.place.size() - 1));
    return row_length * reordered.place[sphere];
}

void Body::Impl::evaluate() {
    Rates rates;
    if (damping.beta > 0) {
        velocities(masses, momentum.data(), pose.data(), velocity.data());
        rates = {velocity.data(), damping.beta};
    }
    field.evaluate(pose.data(), rates, force.data());
    for (ContactState& contact : contacts) {
        if (!contact.acts()) continue;
        contact.at.place(pose.data());
        contact.at.add_force(contact.effective_force(), force.data());
    }
}

void Body::Impl::set_momentum(int place, const Vec3& v, const Vec3& w) {
    const skeleton::Sphere& sphere = reordered.model.spheres[place];
    const Mat3 R = orientation_of(pose.data(), place).toRotationMatrix();
    moves_of(momentum.data(), place) = sphere.mass * v;
    turns_of(momentum.data(), place) = R * (sphere.inertia * (R.transpose() * w));
}

void Body::Impl::set_momenta(double h) {
    const double *from = start.data(), *to = pose.data();
    for (int i = 0; i < std::ssize(reordered.model.spheres); ++i) {
        if (!field.moves()[i]) continue;
        const Eigen::Quaterniond turn = orientation_of(to, i) * orientation_of(from, i).conjugate();
        set_momentum(i, (moves_of(to, i) - moves_of(from, i)) / h,
                     skeleton::rotation_vector(turn.toRotationMatrix()) / h);
    }
}

void Body::Impl::begin_step(double h) {
    if (creep.begin(h, contacts)) solver.forget_contacts();
}

void Body::Impl::end_step(double h) {
    for (ContactState& contact : contacts) {
        if (contact.acts()) contact.at.place(pose.data());
    }
    creep.end(h, contacts);
    field.settle(pose.data());
}

void Body::reset() {
    impl_->pose = impl_->rest;
    for (int tool = 0; tool < impl_->rig.tools.count(); ++tool) impl_->rig.tools.lift(tool);
    for (int tendon = 0; tendon < impl_->rig.tendons.count(); ++tendon) impl_->rig.tendons.let_go(tendon);
    std::ranges::fill(impl_->momentum, 0.0);
    for (ContactState& contact : impl_->contacts) {
        contact.used = false;
        contact.lagged_force.setZero();
    }
    impl_->solver.forget_contacts();
    impl_->field.forget();
}

Eigen::Vector3d Body::position(int sphere) const {
    return Eigen::Map<const Vec3>(impl_->pose.data() + impl_->row(sphere));
}

Eigen::Quaterniond Body::orientation(int sphere) const {
    return Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(impl_->pose.data() + impl_->row(sphere) + 4));
}

void Body::set_pose(int sphere, const Eigen::Vector3d& position, const Eigen::Quaterniond& orientation) {
    double* row = impl_->pose.data() + impl_->row(sphere);
    std::copy_n(position.data(), 3, row);
    std::copy_n(orientation.normalized().coeffs().data(), 4, row + 4);
}

void Body::set_velocity(int sphere, const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
    impl_->require_masses();
    impl_->set_momentum(impl_->row(sphere) / row_length, linear, angular);
}

Energy Body::energy() {
    Impl& own = *impl_;
    const double kinetic = velocities(own.masses, own.momentum.data(), own.pose.data(), own.velocity.data());
    return {kinetic, own.field.evaluate(own.pose.data(), {}, own.force.data())};
}

Momenta Body::momenta() const {
    Momenta sum{Vec3::Zero(), Vec3::Zero()};
    for (std::size_t i = 0; i < impl_->reordered.model.spheres.size(); ++i) {
        if (!impl_->field.moves()[i]) continue;
        const Eigen::Map<const Vec3> x(impl_->pose.data() + row_length * i);
        const Eigen::Map<const Vec3> p(impl_->momentum.data() + row_length * i);
        const Eigen::Map<const Vec3> L(impl_->momentum.data() + row_length * i + 4);
        sum.linear += p;
        sum.angular += x.cross(p) + L;
    }
    return sum;
}

const std::vector<float>& Body::skin() {
    Impl& own = *impl_;
    own.skinning.follow(own.pose.data(), own.skin.data());
    for (ContactState& contact : own.contacts) {
        if (!contact.acts() || contact.dented.empty()) continue;
        contact.at.place(own.pose.data());
        add_dent(own.reordered.model, contact, own.skin);
    }
    if (own.rig.tools.any()) own.rig.tools.press_out(own.pose.data(), own.skin);
    return own.skin;
}

// h <= 2 / w for a mode of frequency w without damping; with the ratio zeta = beta w / 2, as rates are those of the
// last half step, h <= 2 / w (sqrt(1 + zeta^2) - zeta). The power method comes from below: a twentieth is kept back.
constexpr double kept_back = 0.95;
// Newton steps to an equilibrium: lattices take 9 to 15, so a search that needs ten times as many leads nowhere.
constexpr int equilibrium_iterations = 200;

double Body::stable_step() {
    Impl& own = *impl_;
    own.require_masses();
    if (own.stable == 0) {
        const double w = own.solver.stiffest_mode(own.rest.data()), zeta = 0.5 * own.damping.beta * w;
        own.stable = kept_back * 2 / (w * (std::sqrt(1 + zeta * zeta) + zeta));
    }
    return own.stable;
}

void Body::step_explicit(double h, int steps) {
    Impl& own = *impl_;
    own.require_time(h);
    if (own.rig.any())
        throw InvalidInput(
            "a tool is placed or a tendon pulls, which are too stiff for explicit steps: step_implicit, or "
            "lift the tool and let the tendon go first");
    if (steps < 1) return;
    const double dies = std::exp(-own.damping.alpha * h);
    drift(own.masses, 0.5 * h, own.momentum.data(), own.pose.data());
    for (int i = 0; i < steps; ++i) {
        own.begin_step(h);
        own.evaluate();
        kick_and_drift(own.masses, h, dies, own.force.data(), i + 1 < steps ? h : 0.5 * h, own.momentum.data(),
                       own.pose.data());
        own.end_step(h);
    }
}

void Body::Impl::fail(const char* what, const Solver::Report& report) const {
    throw SolverFailure(
        fmt::format("no {} found in {} Newton steps: {:.3g} N were left; lower the forces or raise the stiffness", what,
                    report.iterations, report.residual));
}

void Body::step_implicit(double h) {
    Impl& own = *impl_;
    own.require_time(h);
    velocities(own.masses, own.momentum.data(), own.pose.data(), own.velocity.data());
    std::ranges::copy(own.pose, own.start.begin());
    Solver::Step step;
    step.h = h;
    step.alpha = own.damping.alpha;
    step.beta = own.damping.beta;
    step.tolerance = own.options.step_tolerance;
    step.reuse = true;
    own.begin_step(h);
    Solver::Report report = own.solver.solve(step, own.in_use, own.start.data(), own.velocity.data(), own.pose);
    if (!report.found) {
        std::ranges::copy(own.start, own.pose.begin());
        step.extrapolate = false;
        report = own.solver.solve(step, own.in_use, own.start.data(), own.velocity.data(), own.pose);
    }
    if (!report.found) {
        std::ranges::copy(own.start, own.pose.begin());
        own.fail("state at the end of the step", report);
    }
    own.set_momenta(h);
    own.end_step(h);
}

EquilibriumReport Body::equilibrium() {
    Impl& own = *impl_;
    if (!own.held) throw SolverFailure("the body is unconstrained and has no equilibrium: let a support hold a sphere");
    std::ranges::copy(own.pose, own.start.begin());
    Solver::Step step;
    step.iterations = equilibrium_iterations;
    step.reuse = own.solver.factor_is_expensive();
    own.begin_step(0);
    const Solver::Report report = own.solver.solve(step, own.in_use, nullptr, nullptr, own.pose);
    if (!report.found) {
        std::ranges::copy(own.start, own.pose.begin());
        own.fail("equilibrium", report);
    }
    std::ranges::fill(own.momentum, 0.0);
    own.field.settle(own.pose.data());
    return {report.iterations, report.residual};
}

}  // namespace palpate::runtime
