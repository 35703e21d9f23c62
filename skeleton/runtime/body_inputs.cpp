// What a program does to a body: contacts, tools, tendons, pressure, gravity and damping.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fem/rig/round_shapes.h"
#include "mesh/errors.h"
#include "skeleton/effects/tool_points.h"
#include "skeleton/loads/cavity_walls.h"
#include "skeleton/model/link_modulus.h"
#include "skeleton/runtime/body_impl.h"

namespace palpate::runtime {

namespace {

void require_above(const char* what, double value, double least) {
    if (!(value > least)) throw InvalidInput(fmt::format("{} is {}; it must be above {:g}", what, value, least));
}

void require_finite_pressure(double pressure) {
    if (!std::isfinite(pressure)) throw InvalidInput(fmt::format("the pressure is {}; it must be finite", pressure));
}

}  // namespace

ContactState& Body::Impl::contact(int number) {
    if (number < 0 || number >= static_cast<int>(contacts.size()) || !contacts[number].used)
        throw InvalidInput(fmt::format("contact {} is not in use; touch() gives contacts their numbers", number));
    contacts[number].at.place(pose.data());
    return contacts[number];
}

void Body::Impl::require_tool(int number) const {
    if (number < 0 || number >= rig.tools.count())
        throw InvalidInput(
            fmt::format("tool {} does not exist; add_ball() and add_punch() give tools their numbers from 0", number));
}

int Body::Impl::add_tool(const mesh::Tool& tool, const std::shared_ptr<const fem::RigidShape>& shape, double extent) {
    const double layer = skeleton::layer_stiffness(tool, skeleton::link_modulus(reordered.model));
    return rig.tools.add(shape, extent, layer / options.tool_compliance);
}

void Body::Impl::require_tendon(int number, double value) const {
    if (number < 0 || number >= rig.tendons.count())
        throw InvalidInput(
            fmt::format("tendon {} does not exist; add_tendon() gives tendons their numbers from 0", number));
    if (!(value >= 0) || !std::isfinite(value))
        throw InvalidInput(fmt::format("tendon {} is set to {}; it must be at least 0", number, value));
}

void Body::set_gravity(const Eigen::Vector3d& g) { impl_->field.set_gravity(g); }

int Body::touch(const Eigen::Vector3d& point, double radius) {
    Impl& own = *impl_;
    if (own.triangles.empty() || own.skin.empty())
        throw InvalidInput("the model has no skin that could be touched: give it one");
    // Of those that are free the one of which least is left.
    const auto free = std::ranges::min_element(own.contacts, {}, [](const ContactState& contact) {
        return std::pair(contact.used, contact.lagged_force.squaredNorm());
    });
    if (free == own.contacts.end() || free->used)
        throw InvalidInput(
            fmt::format("all {} contacts are in use; release one, or make the body with more", own.contacts.size()));
    std::vector<float> bare(own.skin.size());  // without dents
    own.skinning.follow(own.pose.data(), bare.data());
    place_contact(own.reordered.model, bare, own.pose.data(), point, radius, *free);
    return static_cast<int>(free - own.contacts.begin());
}

void Body::release(int contact) {
    impl_->creep.release(impl_->contact(contact));
    impl_->solver.forget_contacts();
}

void Body::push(int contact, const Eigen::Vector3d& force) {
    ContactState& own = impl_->contact(contact);
    if (own.mode == ContactState::Mode::drag) impl_->solver.forget_contacts();
    own.mode = ContactState::Mode::push;
    own.dead = force;
    own.creeps = true;
}

void Body::push_without_creep(int contact, const Eigen::Vector3d& force) {
    push(contact, force);
    ContactState& own = impl_->contact(contact);
    own.creeps = false;
    own.gain = 1;
    own.crept.setZero();
    own.lagged_force.setZero();
}

void Body::drag(int contact, const Eigen::Vector3d& to, double stiffness) {
    require_above("the stiffness of a drag", stiffness, 0);
    ContactState& own = impl_->contact(contact);
    if (own.mode != ContactState::Mode::drag || own.stiffness != stiffness) impl_->solver.forget_contacts();
    own.mode = ContactState::Mode::drag;
    own.creeps = true;
    own.target = to;
    own.stiffness = stiffness;
}

Eigen::Vector3d Body::force(int contact) { return impl_->contact(contact).force(); }
Eigen::Vector3d Body::effective_force(int contact) { return impl_->contact(contact).effective_force(); }
Eigen::Vector3d Body::place(int contact) { return impl_->contact(contact).at.x(); }

int Body::add_ball(double radius) {
    require_above("the radius of a ball", radius, 0);
    return impl_->add_tool({.name = "ball", .shape = mesh::SphereShape{radius}}, fem::ball_shape(Vec3::Zero(), radius),
                           radius);
}

// What its shaft pushes aside lies within twice the radius of the face's middle.
int Body::add_punch(double radius, const Eigen::Vector3d& axis) {
    require_above("the radius of a punch", radius, 0);
    require_above("the length of a punch's axis", axis.norm(), 0);
    const mesh::FlatShape punch{radius, axis};
    return impl_->add_tool({.name = "punch", .shape = punch}, fem::punch_shape(Vec3::Zero(), punch), 2 * radius);
}

void Body::place_tool(int tool, const Eigen::Vector3d& at, const Eigen::Quaterniond& turn) {
    impl_->require_tool(tool);
    if (!at.allFinite()) throw InvalidInput(fmt::format("tool {} is placed at a point that is not finite", tool));
    if (!(turn.norm() > 0) || !turn.coeffs().allFinite())
        throw InvalidInput(
            fmt::format("tool {} is turned by a quaternion that is none: its length must be above 0", tool));
    impl_->rig.tools.place(tool, at, turn.normalized().toRotationMatrix());
}

void Body::lift_tool(int tool) {
    impl_->require_tool(tool);
    impl_->rig.tools.lift(tool);
}

ToolLoad Body::tool_load(int tool) {
    impl_->require_tool(tool);
    return impl_->rig.tools.load(tool, impl_->pose.data());
}

// As fem::TendonTerms has it: so many times as stiff as a bar of the links' modulus, its length and as thick.
constexpr double cable_stiffness = 1e3;

int Body::add_tendon(const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& path) {
    double length = 0;
    for (Eigen::Index k = 1; k < path.rows(); ++k) length += (path.row(k) - path.row(k - 1)).norm();
    return impl_->rig.tendons.add(path, cable_stiffness * skeleton::link_modulus(impl_->reordered.model) * length);
}

void Body::pull_tendon(int tendon, double tension) {
    impl_->require_tendon(tendon, tension);
    impl_->rig.tendons.pull(tendon, tension);
}

void Body::draw_tendon(int tendon, double length) {
    impl_->require_tendon(tendon, length);
    impl_->rig.tendons.draw(tendon, length);
}

void Body::let_tendon_go(int tendon) {
    impl_->require_tendon(tendon, 0);
    impl_->rig.tendons.let_go(tendon);
}

double Body::tendon_tension(int tendon) {
    impl_->require_tendon(tendon, 0);
    return impl_->rig.tendons.tension(tendon, impl_->pose.data());
}

void Body::set_pressure(double pressure) {
    require_finite_pressure(pressure);
    impl_->field.set_pressure(pressure);
}

int Body::find_cavity(const Eigen::Vector3d& point) const {
    const skeleton::Model& model = impl_->reordered.model;
    const int found = skeleton::find_cavity(model, skeleton::walls_by_cavity(model), {point});
    if (found < 0) throw InvalidInput("the model's skin encloses no cavity");
    return found;
}

void Body::set_cavity_pressure(int cavity, double pressure) {
    require_finite_pressure(pressure);
    impl_->field.set_cavity_pressure(cavity, pressure);
}

void Body::set_damping(const RayleighDamping& damping) {
    if (!(damping.alpha >= 0) || !(damping.beta >= 0))
        throw InvalidInput(
            fmt::format("damping is {} 1/s and {} s; both must be at least 0", damping.alpha, damping.beta));
    impl_->damping = damping;
    impl_->stable = 0;
}

const RayleighDamping& Body::damping() const { return impl_->damping; }

}  // namespace palpate::runtime
