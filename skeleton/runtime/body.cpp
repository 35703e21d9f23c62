#include "skeleton/runtime/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/rig/round_shapes.h"
#include "mesh/errors.h"
#include "skeleton/effects/effect.h"
#include "skeleton/effects/tool_points.h"
#include "skeleton/model/growth.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/model/link_modulus.h"
#include "skeleton/runtime/contacts/creep.h"
#include "skeleton/runtime/kernels/motion.h"
#include "skeleton/runtime/kernels/skinning.h"
#include "skeleton/runtime/solver/solver.h"
#include "skeleton/runtime/tools/rig.h"
#include "skeleton/runtime/walk_order.h"

namespace palpate::runtime {

namespace {

std::vector<std::string> what_is_not_played(const skeleton::Model& model) {
    std::vector<std::string> words;
    if (model.law == skeleton::EquilibriumLaw::linear)
        words.emplace_back("the model follows the linear law; it is played in large rotation");
    for (const skeleton::EffectRecord& effect : model.effects) {
        const skeleton::KnownEffect* known = skeleton::find_known_effect(effect.name);
        if (!known) continue;
        if (known->kind == skeleton::EffectKind::measurement)
            words.push_back(fmt::format("effect '{}' is about the measurement, not the body", effect.name));
        if (!known->not_played.empty()) words.push_back(fmt::format("effect '{}' {}", effect.name, known->not_played));
    }
    return words;
}

/// Its skin as far out as the material has grown, to be shown. Contacts and effects act on it as it hangs in the model.
skeleton::Model with_grown_skin(skeleton::Model model) {
    const fem::Growth growth = skeleton::physics_of(model.effects).growth;
    const skeleton::State rest = skeleton::rest_state(model);
    for (skeleton::Attachment& point : model.skin) point = skeleton::grown(std::move(point), rest, growth);
    return model;
}

/// Where it begins: at rest, or as large as the material has grown.
SphereRows start_rows(const skeleton::Model& model) {
    SphereRows rows = rest_rows(model);
    const skeleton::State start = skeleton::grown_start(model, skeleton::physics_of(model.effects).growth);
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        for (int c = 0; c < 3; ++c) rows[row_length * i + c] = start.x(static_cast<Eigen::Index>(i), c);
    }
    return rows;
}

void require_above(const char* what, double value, double least) {
    if (!(value > least)) throw InvalidInput(fmt::format("{} is {}; it must be above {:g}", what, value, least));
}

}  // namespace

void BodyOptions::validate() const {
    if (damping_ratio && !(*damping_ratio >= 0 && std::isfinite(*damping_ratio)))
        throw InvalidInput(fmt::format("damping_ratio is {}; it must be at least 0", *damping_ratio));
    if (contacts < 0 || contacts > 64)
        throw InvalidInput(fmt::format("contacts is {}; it must lie in 0 to 64", contacts));
    if (!(step_tolerance > 0 && step_tolerance < 1))
        throw InvalidInput(fmt::format("step_tolerance is {}; it must lie between 0 and 1", step_tolerance));
    if (!(tool_compliance >= 1e-4 && tool_compliance <= 10))
        throw InvalidInput(fmt::format("tool_compliance is {}; it must lie in 1e-4 to 10", tool_compliance));
}

struct Body::Impl {
    BodyOptions options;
    ReorderedModel reordered;
    ForceField field;
    Rig rig;
    Solver solver;
    Skinning skinning;
    MassTable masses;
    std::vector<std::string> notices;
    SphereRows rest, pose, start, momentum, velocity, force;
    std::vector<ContactState> contacts;
    std::vector<ContactState*> in_use;  // all contacts, as the solver wants them
    CreepIntegrator creep;
    std::vector<float> skin;
    std::vector<int> triangles;
    RayleighDamping damping;
    double stable = 0;  // [s]; 0: not known yet
    bool held = false;
    int massless = -1;  // a sphere that moves and has no mass, by its number in the file

    Impl(const skeleton::Model& model, const BodyOptions& how)
        : options(how),
          reordered(in_cuthill_mckee_order(model)),
          field(reordered.model),
          rig(reordered.model),
          solver(field, options.contacts, rig),
          skinning(with_grown_skin(reordered.model)),
          masses(mass_table(reordered.model, field.moves())),
          notices(what_is_not_played(model)),
          rest(start_rows(reordered.model)),
          contacts(options.contacts),
          creep(skeleton::physics_of(model.effects).creep) {
        pose = start = rest;
        for (SphereRows* rows : {&momentum, &velocity, &force}) rows->assign(rest.size(), 0.0);
        for (ContactState& contact : contacts) in_use.push_back(&contact);
        skin.resize(3 * reordered.model.skin.size());
        triangles.assign(model.surface.triangles.data(),
                         model.surface.triangles.data() + model.surface.triangles.size());
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            const bool moves = field.moves()[reordered.place[i]] != 0;
            held = held || !moves || model.spheres[i].held;
            const bool heavy = model.spheres[i].mass > 0 && model.spheres[i].inertia.determinant() > 0;
            if (moves && !heavy && massless < 0) massless = static_cast<int>(i);
        }
        if (model.damping && !options.damping_ratio) {
            damping = {model.damping->alpha, model.damping->beta};
            return;
        }
        const double ratio = options.damping_ratio.value_or(0.1);
        if (massless < 0 && held && ratio > 0) {
            const double softest = solver.softest_mode(rest.data());
            if (softest > 0) damping.beta = 2 * ratio / softest;
        }
    }

    void require_masses() const {
        if (massless < 0) return;
        throw InvalidInput(fmt::format(
            "sphere {} moves and has no mass, or no inertia; motion needs one: give it a 'mass' above 0", massless));
    }
    void require_time(double h) const {
        if (!(h > 0) || !std::isfinite(h)) throw InvalidInput(fmt::format("the step is {} s; it must be above 0", h));
        require_masses();
    }
    ContactState& contact(int number) {
        if (number < 0 || number >= static_cast<int>(contacts.size()) || !contacts[number].used)
            throw InvalidInput(fmt::format("contact {} is not in use; touch() gives contacts their numbers", number));
        contacts[number].at.place(pose.data());
        return contacts[number];
    }
    void require_tool(int number) const {
        if (number < 0 || number >= rig.tools.count())
            throw InvalidInput(fmt::format(
                "tool {} does not exist; add_ball() and add_punch() give tools their numbers from 0", number));
    }
    int add_tool(const mesh::Tool& tool, const std::shared_ptr<const fem::RigidShape>& shape, double extent) {
        const double layer = skeleton::layer_stiffness(tool, skeleton::link_modulus(reordered.model));
        return rig.tools.add(shape, extent, layer / options.tool_compliance);
    }
    void require_tendon(int number, double value) const {
        if (number < 0 || number >= rig.tendons.count())
            throw InvalidInput(
                fmt::format("tendon {} does not exist; add_tendon() gives tendons their numbers from 0", number));
        if (!(value >= 0) || !std::isfinite(value))
            throw InvalidInput(fmt::format("tendon {} is set to {}; it must be at least 0", number, value));
    }
    int row(int sphere) const {
        if (sphere < 0 || sphere >= static_cast<int>(reordered.place.size()))
            throw InvalidInput(fmt::format("sphere {} does not exist; spheres are numbered from 0 to {}", sphere,
                                           reordered.place.size() - 1));
        return row_length * reordered.place[sphere];
    }

    // Forces where it stands, with those of contacts; rates by the momenta.
    void evaluate() {
        Rates rates;
        if (damping.beta > 0) {
            velocities(masses, momentum.data(), pose.data(), velocity.data());
            rates = {velocity.data(), damping.beta};
        }
        field.evaluate(pose.data(), rates, force.data());
        for (ContactState& contact : contacts) {
            if (!contact.acts()) continue;
            contact.at.place(pose.data());
            contact.at.pull_back(contact.effective_force(), [&](int sphere, const Vec3& f, const Vec3& t) {
                Eigen::Map<Vec3>(force.data() + row_length * sphere) += f;
                Eigen::Map<Vec3>(force.data() + row_length * sphere + 4) += t;
            });
        }
    }

    // Momenta of a sphere that moves by v and w.
    void set_momentum(int place, const Vec3& v, const Vec3& w) {
        const skeleton::Sphere& sphere = reordered.model.spheres[place];
        const Eigen::Map<const Eigen::Vector4d> q(pose.data() + row_length * place + 4);
        const Mat3 R = Eigen::Quaterniond(Eigen::Vector4d(q)).toRotationMatrix();
        Eigen::Map<Vec3> p(momentum.data() + row_length * place), L(momentum.data() + row_length * place + 4);
        p = sphere.mass * v;
        L = R * (sphere.inertia * (R.transpose() * w));
    }

    // Velocities and momenta of a step of h from `start` to `pose`.
    void set_momenta(double h) {
        for (std::size_t i = 0; i < reordered.model.spheres.size(); ++i) {
            if (!field.moves()[i]) continue;
            const double *from = start.data() + row_length * i, *to = pose.data() + row_length * i;
            const Eigen::Quaterniond q_from(Eigen::Map<const Eigen::Vector4d>(from + 4)),
                q_to(Eigen::Map<const Eigen::Vector4d>(to + 4));
            const Vec3 w = skeleton::rotation_vector((q_to * q_from.conjugate()).toRotationMatrix()) / h;
            set_momentum(static_cast<int>(i), (Eigen::Map<const Vec3>(to) - Eigen::Map<const Vec3>(from)) / h, w);
        }
    }

    void begin_step(double h) {
        if (creep.begin(h, contacts)) solver.forget_contacts();
    }
    void end_step(double h) {
        for (ContactState& contact : contacts) {
            if (contact.acts()) contact.at.place(pose.data());
        }
        creep.end(h, contacts);
        field.settle(pose.data());
    }

    [[noreturn]] void fail(const char* what, const Solver::Report& report) const {
        throw SolverFailure(
            fmt::format("no {} found in {} Newton steps: {:.3g} N were left; lower the forces or raise the stiffness",
                        what, report.iterations, report.residual));
    }
};

Body::Body(const std::filesystem::path& model, const BodyOptions& options)
    : Body(skeleton::read_model(model), options) {}
Body::Body(const skeleton::Model& model, const BodyOptions& options) {
    options.validate();
    impl_ = std::make_unique<Impl>(model, options);
}
Body::~Body() = default;
Body::Body(Body&&) noexcept = default;
Body& Body::operator=(Body&&) noexcept = default;

const std::vector<std::string>& Body::notices() const { return impl_->notices; }
int Body::sphere_count() const { return static_cast<int>(impl_->reordered.model.spheres.size()); }
int Body::link_count() const { return static_cast<int>(impl_->reordered.model.links.size()); }
int Body::vertex_count() const { return static_cast<int>(impl_->reordered.model.skin.size()); }

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

const std::vector<int>& Body::triangles() const { return impl_->triangles; }

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

// A thousand times as stiff as a bar of the links' modulus, its length and as thick, as fem::TendonTerms has it.
int Body::add_tendon(const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& path) {
    double length = 0;
    for (Eigen::Index k = 1; k < path.rows(); ++k) length += (path.row(k) - path.row(k - 1)).norm();
    return impl_->rig.tendons.add(path, 1e3 * skeleton::link_modulus(impl_->reordered.model) * length);
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
    if (!std::isfinite(pressure)) throw InvalidInput(fmt::format("the pressure is {}; it must be finite", pressure));
    impl_->field.set_pressure(pressure);
}

void Body::set_damping(const RayleighDamping& damping) {
    if (!(damping.alpha >= 0) || !(damping.beta >= 0))
        throw InvalidInput(
            fmt::format("damping is {} 1/s and {} s; both must be at least 0", damping.alpha, damping.beta));
    impl_->damping = damping;
    impl_->stable = 0;
}

const RayleighDamping& Body::damping() const { return impl_->damping; }

// h <= 2 / w for a mode of frequency w without damping; with the ratio zeta = beta w / 2, as rates are those of the
// last half step, h <= 2 / w (sqrt(1 + zeta^2) - zeta). The power method comes from below: a twentieth is kept back.
double Body::stable_step() {
    Impl& own = *impl_;
    own.require_masses();
    if (own.stable == 0) {
        const double w = own.solver.stiffest_mode(own.rest.data()), zeta = 0.5 * own.damping.beta * w;
        own.stable = 0.95 * 2 / (w * (std::sqrt(1 + zeta * zeta) + zeta));
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
    step.iterations = 200;
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
