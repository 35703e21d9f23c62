#include "pipeline/play/touch/touched_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "mesh/errors.h"
#include "skeleton/loads/cavity_walls.h"
#include "skeleton/loads/dent.h"
#include "skeleton/model/link_modulus.h"
#include "skeleton/model/observation.h"

namespace palpate::pipeline {
namespace {

// The runtime plays every model in large rotation: what is asked of it statically must be of the same law.
skeleton::Model as_played(skeleton::Model model, double pressure) {
    model.law = skeleton::EquilibriumLaw::large_rotation;
    if (pressure != 0) model.effects.push_back({"pressure", {{"pressure", pressure, "MPa"}}});
    return model;
}

// Steps that are shown may leave a micrometre.
const runtime::BodyOptions for_display{.contacts = TouchedModel::most_touches, .step_tolerance = 1e-4};

}  // namespace

TouchedModel::TouchedModel(skeleton::Model model, const Vec3& gravity, double pressure)
    : model_(as_played(std::move(model), pressure)),
      body_(model_, for_display),
      to_load_(model_),
      k_(skeleton::stiffness_vector(model_)),
      touches_(most_touches),
      unit_loads_(most_touches),
      gravity_(gravity) {
    body_.set_gravity(gravity);
}

TouchedModel::Touch& TouchedModel::at(int touch) {
    if (touch < 0 || touch >= most_touches || touches_[touch].contact < 0)
        throw InvalidInput(fmt::format("touch {} is not in use", touch));
    return touches_[touch];
}

void TouchedModel::take_over(const TouchedModel& other) {
    reset();
    for (int t = 0; t < most_touches; ++t) {
        const Touch& was = other.touches_[t];
        if (was.contact < 0) continue;
        touches_[t] = was;
        touches_[t].contact = body_.touch(was.rest, was.radius);
        unit_loads_[t] = to_load_({{was.rest, Vec3::UnitX(), was.radius}});
        if (was.drags) {
            drag(t, was.vector, was.stiffness);
        } else {
            was.creeps ? push(t, was.vector) : push_without_creep(t, was.vector);
        }
    }
    if (other.ball_.is_placed) place_ball(other.ball_.radius, other.ball_.at);
    stand_as(other.state());
}

void TouchedModel::reset() {
    body_.reset();
    std::ranges::fill(touches_, Touch());
    ball_.is_placed = false;
    for (int a = 0; a < std::ssize(actuators_); ++a) drive(a, 0);
}

int TouchedModel::touch(const Vec3& rest, double radius) {
    const auto free = std::ranges::find(touches_, -1, &Touch::contact);
    if (free == touches_.end()) throw InvalidInput("all touches are in use; release one");
    // The body takes the skin that is nearest as it stands: let it stand at rest meanwhile.
    const skeleton::State now = state();
    stand_as(skeleton::rest_state(model_));
    free->contact = body_.touch(rest, radius);
    free->rest = body_.place(free->contact);
    if (radius > 0) free->rest = rest;
    free->radius = radius;
    stand_as(now);
    const int touch = static_cast<int>(free - touches_.begin());
    unit_loads_[touch] = to_load_({{free->rest, Vec3::UnitX(), radius}});
    return touch;
}

void TouchedModel::release(int touch) {
    body_.release(at(touch).contact);
    at(touch) = Touch();
}

void TouchedModel::push(int touch, const Vec3& force) {
    Touch& own = at(touch);
    own.drags = false;
    own.creeps = true;
    own.vector = force;
    body_.push(own.contact, force);
}

void TouchedModel::push_without_creep(int touch, const Vec3& force) {
    push(touch, force);
    at(touch).creeps = false;
    body_.push_without_creep(at(touch).contact, force);
}

void TouchedModel::drag(int touch, const Vec3& to, double stiffness) {
    Touch& own = at(touch);
    own.drags = own.creeps = true;
    own.vector = to;
    own.stiffness = stiffness;
    body_.drag(own.contact, to, stiffness);
}

Vec3 TouchedModel::force(int touch) { return body_.force(at(touch).contact); }
Vec3 TouchedModel::effective_force(int touch) { return body_.effective_force(at(touch).contact); }
Vec3 TouchedModel::place(int touch) { return body_.place(at(touch).contact); }

void TouchedModel::place_ball(double radius, const Vec3& at) {
    if (ball_.tool < 0 || ball_.radius != radius) {
        lift_ball();
        ball_.tool = body_.add_ball(radius);
        ball_.radius = radius;
    }
    ball_.is_placed = true;
    ball_.at = at;
    body_.place_tool(ball_.tool, at);
}

void TouchedModel::lift_ball() {
    if (ball_.tool >= 0) body_.lift_tool(ball_.tool);
    ball_.is_placed = false;
}

Vec3 TouchedModel::ball_force() { return ball_.is_placed ? body_.tool_load(ball_.tool).force : Vec3::Zero().eval(); }

TouchedModel::Driven& TouchedModel::driven(int actuator) {
    if (actuator < 0 || actuator >= std::ssize(actuators_))
        throw InvalidInput(
            fmt::format("actuator {} does not exist; there are {}, numbered from 0", actuator, actuators_.size()));
    return actuators_[actuator];
}

int TouchedModel::add_actuator(const mesh::Actuator& actuator) {
    Driven own{actuator};
    if (const auto* tendon = std::get_if<mesh::TendonActuator>(&actuator.kind)) {
        own.number = body_.add_tendon(tendon->path);
    } else {
        own.number = skeleton::find_cavity(model_, skeleton::walls_by_cavity(model_),
                                           std::get<mesh::PressureActuator>(actuator.kind));
        if (own.number < 0) throw InvalidInput(fmt::format("{}: the model's skin encloses no cavity", actuator.name));
    }
    actuators_.push_back(std::move(own));
    return static_cast<int>(actuators_.size()) - 1;
}

void TouchedModel::drive(int actuator, double value) {
    Driven& own = driven(actuator);
    const auto* tendon = std::get_if<mesh::TendonActuator>(&own.actuator.kind);
    if (!tendon) {
        body_.set_cavity_pressure(own.number, value);
    } else if (tendon->by_length) {
        body_.draw_tendon(own.number, value);
    } else {
        body_.pull_tendon(own.number, value);
    }
    own.value = value;
    solver_.reset();
}

double TouchedModel::tension(int actuator) {
    const Driven& own = driven(actuator);
    if (!std::holds_alternative<mesh::TendonActuator>(own.actuator.kind))
        throw InvalidInput(own.actuator.name + ": is no tendon");
    return body_.tendon_tension(own.number);
}

fem::Effects TouchedModel::driven_effects() const {
    fem::Effects effects;
    for (const Driven& own : actuators_) {
        if (const auto* tendon = std::get_if<mesh::TendonActuator>(&own.actuator.kind)) {
            effects.tendons.push_back(
                {std::make_shared<mesh::TendonActuator>(*tendon), own.value, skeleton::link_modulus(model_)});
        } else if (own.value != 0) {
            effects.cavities.push_back(
                {std::make_shared<mesh::PressureActuator>(std::get<mesh::PressureActuator>(own.actuator.kind)),
                 own.value});
        }
    }
    return effects;
}

void TouchedModel::advance(double h) {
    constexpr int parts = 4;
    try {
        body_.step_implicit(h);
    } catch (const SolverFailure&) {
        for (int i = 0; i < parts; ++i) body_.step_implicit(h / parts);
    }
}

std::optional<Mat3> TouchedModel::compliance(int touch) {
    at(touch);
    skeleton::Equilibrium here;
    here.state = state();
    // columns: generalized forces of a unit force along x, y, z
    skeleton::Load unit = unit_loads_[touch];
    Eigen::MatrixXd B(model_.dofs(), 3);
    for (int c = 0; c < 3; ++c) {
        unit.forces.front().force = Vec3::Unit(c);
        B.col(c) = skeleton::external_force(model_, here.state, unit);
    }
    if (!solver_) solver_.emplace(model_, driven_effects());
    try {
        solver_->factor_tangent(k_, load(), here);
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
    return B.transpose() * solver_->solve_tangent(B);
}

void TouchedModel::stand_as(const skeleton::State& state) {
    for (int i = 0; i < body_.sphere_count(); ++i) {
        body_.set_pose(i, state.x.row(i).transpose(), Eigen::Quaterniond(state.R[i]));
    }
}

skeleton::State TouchedModel::state() const {
    skeleton::State state{Points(body_.sphere_count(), 3), {}};
    for (int i = 0; i < body_.sphere_count(); ++i) {
        state.x.row(i) = body_.position(i).transpose();
        state.R.push_back(body_.orientation(i).toRotationMatrix());
    }
    return state;
}

skeleton::Load TouchedModel::load() {
    skeleton::Load load;
    load.gravity = gravity_;
    for (int t = 0; t < most_touches; ++t) {
        if (touches_[t].contact < 0) continue;
        const Vec3 now = effective_force(t);
        for (const skeleton::PointForce& one : unit_loads_[t].forces) load.forces.push_back({one.at, now});
        for (skeleton::PatchForce press : unit_loads_[t].patch_forces) {
            press.force = now;
            load.patch_forces.push_back(std::move(press));
        }
    }
    return load;
}

Points TouchedModel::places(const std::vector<skeleton::Attachment>& points) {
    Points rest(std::ssize(points), 3);
    for (std::size_t i = 0; i < points.size(); ++i) rest.row(static_cast<Eigen::Index>(i)) = points[i].rest.transpose();
    const skeleton::Load now = load();
    Points result = skeleton::observe(model_, state(), points);
    if (!now.patch_forces.empty()) result += skeleton::dents(model_, now, rest);
    return result;
}

}  // namespace palpate::pipeline
