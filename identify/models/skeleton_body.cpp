#include "identify/models/skeleton_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

#include "identify/loading/loads.h"
#include "identify/models/free_tools.h"
#include "identify/models/tendon_friction.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/model/attach.h"
#include "skeleton/model/growth.h"
#include "skeleton/model/stiffness_order.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

using skeleton::Equilibrium;
using skeleton::EquilibriumLaw;
using skeleton::State;

Eigen::VectorXd pack(const State& state) {
    const Eigen::Index N = state.x.rows();
    Eigen::VectorXd q(12 * N);
    for (Eigen::Index i = 0; i < N; ++i) {
        q.segment<3>(3 * i) = state.x.row(i);
        q.segment<9>(3 * N + 9 * i) = state.R[i].reshaped();
    }
    return q;
}

State unpack(const Eigen::VectorXd& q) {
    const Eigen::Index N = q.size() / 12;
    State state{Points(N, 3), std::vector<Mat3>(N)};
    for (Eigen::Index i = 0; i < N; ++i) {
        state.x.row(i) = q.segment<3>(3 * i);
        state.R[i] = q.segment<9>(3 * N + 9 * i).reshaped(3, 3);
    }
    return state;
}

bool in_large_rotation(const ModelSetting& setting) {
    return static_cast<EquilibriumLaw>(setting.law) != EquilibriumLaw::linear;
}

class SolverTangent : public Tangent {
public:
    SolverTangent(const skeleton::Model& model, const fem::Effects& effects, const Eigen::VectorXd& k,
                  const skeleton::Load& load, const Equilibrium& at)
        : solver_(model, effects), dofs_(model.dofs()) {
        solver_.factor_tangent(k, load, at);
    }
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override { return solver_.solve_tangent(B); }
    /// An estimate: at most 500 entries of the factor for each degree of freedom.
    double gigabytes() const override { return 8e-9 * dofs_ * std::min(dofs_, 500); }

private:
    skeleton::StaticsSolver solver_;
    int dofs_;
};

/// What the links' fibres have been through.
class FibreMemory : public Memory {
public:
    explicit FibreMemory(skeleton::FibreStates states) : fibres(std::move(states)) {}
    skeleton::FibreStates fibres;
};

const skeleton::FibreStates& fibres_before(const Action& action) {
    static const skeleton::FibreStates none;
    const auto* own = dynamic_cast<const FibreMemory*>(action.memory.get());
    return own ? own->fibres : none;
}

}  // namespace

struct SkeletonBody::Impl {
    explicit Impl(const Rig& the_rig) : rig(the_rig) {}
    PreparedRig rig;
    std::array<skeleton::Model, 2> by_law;  // the same but for the law
    std::vector<skeleton::Attachment> markers;
    std::vector<std::string> laws;
    std::vector<StiffnessParameter> parameters;
    Eigen::VectorXd k0;             // as skeleton::StiffnessOrder says
    std::vector<int> parameter_of;  // of each stiffness
    double young, size;
    Points centres, support_points;
    std::vector<char> at_support;
    Eigen::VectorXd support_shares, skin_areas;
    Points spheres;  // where they rest
    Eigen::VectorXd mass_shares;
    bool has_cavities;
    std::unique_ptr<ContactLoads> loads;

    void find_kinds(double prior_sd, const std::vector<InformativePrior>& priors);

    using Place = std::tuple<double, double, double, double>;
    mutable std::mutex mutex;
    mutable std::map<Place, skeleton::Load> shares;  // of a force of 1 N along x

    const skeleton::Model& model(const ModelSetting& setting) const { return by_law[setting.law]; }
    Eigen::RowVectorXd weight_of(const skeleton::StiffnessOrder& order, Eigen::Index place,
                                 const Eigen::MatrixXd& W) const;
    skeleton::Load shares_of(const mesh::Contact& contact) const;
    skeleton::Load load(const Action& action) const;
    /// What is in force: a pressure that is known to act does so in cavities, where there are any.
    fem::Effects effects(const ModelSetting& setting, const Action& action) const {
        fem::Effects result = setting.effects;
        if (has_cavities) result.pressure += action.pressure;
        rig.add(action, young_of(setting), result);
        return result;
    }
    /// Points as far out as the material that carries them has grown.
    std::vector<skeleton::Attachment> grown(std::vector<skeleton::Attachment> points,
                                            const ModelSetting& setting) const {
        const fem::Growth& growth = setting.effects.growth;
        if (growth.none()) return points;
        const State rest = skeleton::rest_state(model(setting));
        for (skeleton::Attachment& point : points) point = skeleton::grown(std::move(point), rest, growth);
        return points;
    }
    /// Of the tendons that rub.
    fem::TendonSliding sliding(const Eigen::VectorXd& q, const ModelSetting& setting,
                               const fem::Effects& effects) const {
        std::vector<fem::TendonSliding> each;
        for (const fem::TendonPull& pull : effects.tendons)
            if (pull.coefficient != 0)
                each.push_back(skeleton::PlacedTendon(model(setting), pull).sliding(equilibrium_of(q, setting).state));
        return together(each, by_law[0].dofs());
    }
    /// What the linear law expands about rest takes friction as it is in `state`.
    void hold_friction(const State& state, fem::Effects& effects) const {
        for (fem::TendonPull& pull : effects.tendons)
            if (pull.coefficient != 0) pull.friction = skeleton::PlacedTendon(by_law[0], pull).friction(state);
    }
    double young_of(const ModelSetting& setting) const { return young * std::exp(setting.theta.mean()); }
    /// A configuration as the statics know it.
    Equilibrium equilibrium_of(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action = {}) const {
        Equilibrium at;
        at.before = fibres_before(action);
        if (static_cast<EquilibriumLaw>(setting.law) == EquilibriumLaw::linear) {
            at.step = q;
            at.state = skeleton::advance(skeleton::rest_state(by_law[0]), q);
        } else {
            at.state = unpack(q);
        }
        return at;
    }
    /// Forces of tools and of tendons of a given length, on all spheres (6N).
    Eigen::VectorXd grip_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action) const;
    /// Calls visit(point, where it is, the potential's terms times its weight) for the points that feel a tool.
    template <class Visit>
    void for_each_point_of(const mesh::ToolMotion& motion, const Eigen::VectorXd& q, const ModelSetting& setting,
                           const Visit& visit) const;
    State tangent_state(const Eigen::VectorXd& q, const ModelSetting& setting) const {
        return static_cast<EquilibriumLaw>(setting.law) == EquilibriumLaw::linear ? skeleton::rest_state(by_law[0])
                                                                                  : unpack(q);
    }
};

SkeletonBody::SkeletonBody(const skeleton::Model& model, const std::vector<Marker>& markers, double young,
                           const Rig& rig, double prior_sd, const std::vector<InformativePrior>& priors)
    : impl_(std::make_unique<Impl>(rig)) {
    Impl& i = *impl_;
    for (int law = 0; law < 2; ++law) {
        i.by_law[law] = model;
        i.by_law[law].effects.clear();
        i.by_law[law].law = static_cast<EquilibriumLaw>(law);
        i.laws.emplace_back(skeleton::law_names[law]);
    }
    const skeleton::Attacher attach(model);
    for (const Marker& marker : markers) {
        i.markers.push_back(attach(marker.anchor.value_or(marker.rest), marker.rest));
    }
    i.k0 = skeleton::stiffness_vector(model);
    i.find_kinds(prior_sd, priors);
    i.young = young;
    const Points& reach = model.surface.vertices;
    i.spheres.resize(std::ssize(model.spheres), 3);
    i.mass_shares.resize(std::ssize(model.spheres));
    for (std::size_t s = 0; s < model.spheres.size(); ++s) {
        i.spheres.row(static_cast<Eigen::Index>(s)) = model.spheres[s].center;
        i.mass_shares[static_cast<Eigen::Index>(s)] = model.spheres[s].mass;
    }
    // A model without masses: all spheres alike.
    if (!(i.mass_shares.sum() > 0)) i.mass_shares.setOnes();
    i.mass_shares /= i.mass_shares.sum();
    const Points& extent = reach.rows() > 0 ? reach : i.spheres;
    i.size = (extent.colwise().maxCoeff() - extent.colwise().minCoeff()).maxCoeff();

    i.centres.resize(std::ssize(model.links), 3);
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        const skeleton::Link& link = model.links[l];
        i.centres.row(static_cast<Eigen::Index>(l)) =
            0.5 * (model.spheres[link.a].center + model.spheres[link.b].center).transpose();
        i.at_support.push_back(model.spheres[link.a].held != model.spheres[link.b].held);
    }
    const skeleton::PointSet support = skeleton::point_set(model, fem::ActsOn::support);
    i.support_points.resize(std::ssize(support.at), 3);
    for (std::size_t p = 0; p < support.at.size(); ++p) {
        i.support_points.row(static_cast<Eigen::Index>(p)) = support.at[p].rest;
    }
    i.support_shares = support.weights;
    if (!model.skin.empty()) i.skin_areas = skeleton::point_set(model, fem::ActsOn::surface).weights;
    i.has_cavities = !skeleton::Cavities(model).empty();
    i.loads = std::make_unique<ContactLoads>(i.by_law[0]);
}

SkeletonBody::~SkeletonBody() = default;

// A parameter for each kind of stiffness that the model has.
void SkeletonBody::Impl::find_kinds(double prior_sd, const std::vector<InformativePrior>& priors) {
    const skeleton::StiffnessOrder order(by_law[0]);
    std::vector<int> place(skeleton::stiffness_names.size(), -1);
    for (Eigen::Index k = 0; k < order.size(); ++k) {
        const auto kind = static_cast<int>(skeleton::as_identified(order.kind(k)));
        if (place[kind] < 0 && (kind < 3 || k0[k] > 0)) {
            place[kind] = static_cast<int>(parameters.size());
            parameters.push_back({skeleton::stiffness_names[kind], 0, 0, prior_sd});
        }
        parameter_of.push_back(place[kind]);
    }
    // A parameter is the logarithm of a multiplier on the geometric mean of what the model has.
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        const InformativePrior* told = prior_of(parameters[p].name, prior_sd, priors);
        if (!told) continue;
        double sum = 0, count = 0;
        for (Eigen::Index k = 0; k < order.size(); ++k) {
            if (parameter_of[static_cast<std::size_t>(k)] != static_cast<int>(p) || !(k0[k] > 0)) continue;
            sum += std::log(k0[k]);
            ++count;
        }
        if (count == 0) continue;
        parameters[p].prior_mean = told->mean - sum / count;
        parameters[p].prior_sd = told->sd;
    }
}

skeleton::Load SkeletonBody::Impl::shares_of(const mesh::Contact& contact) const {
    const Place place{contact.point.x(), contact.point.y(), contact.point.z(), contact.radius};
    {
        const std::scoped_lock lock(mutex);
        if (const auto found = shares.find(place); found != shares.end()) return found->second;
    }
    skeleton::Load result = (*loads)({{contact.point, Vec3::UnitX(), contact.radius}});
    const std::scoped_lock lock(mutex);
    return shares.emplace(place, std::move(result)).first->second;
}

skeleton::Load SkeletonBody::Impl::load(const Action& action) const {
    skeleton::Load result;
    result.gravity = action.gravity;
    for (const mesh::Contact& contact : action.contacts) {
        if (contact.force.isZero(0)) continue;
        for (const skeleton::PointForce& part : shares_of(contact).forces) {
            result.forces.push_back({part.at, part.force.x() * contact.force});
        }
    }
    return result;
}

int SkeletonBody::dofs() const { return impl_->by_law[0].dofs(); }
const std::vector<std::string>& SkeletonBody::laws() const { return impl_->laws; }
const std::vector<StiffnessParameter>& SkeletonBody::parameters() const { return impl_->parameters; }
double SkeletonBody::size() const { return impl_->size; }
double SkeletonBody::young(const ModelSetting& setting) const { return impl_->young_of(setting); }
bool SkeletonBody::is_nonlinear(const ModelSetting& setting) const {
    return in_large_rotation(setting) || impl_->rig.is_nonlinear();
}

skeleton::Equilibrium SkeletonBody::equilibrium_at(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return impl_->equilibrium_of(q, setting);
}

Eigen::VectorXd SkeletonBody::stiffness(const ModelSetting& setting) const {
    Eigen::VectorXd k = impl_->k0;
    for (Eigen::Index place = 0; place < k.size(); ++place) {
        const int kind = impl_->parameter_of[place];
        if (kind >= 0) k[place] *= std::exp(setting.theta[kind]);
    }
    return k;
}

Eigen::VectorXd SkeletonBody::rest(const ModelSetting& setting) const {
    if (!in_large_rotation(setting)) return Eigen::VectorXd::Zero(dofs());
    return pack(skeleton::rest_state(impl_->by_law[0]));
}

Eigen::VectorXd SkeletonBody::equilibrium(const ModelSetting& setting, const Action& action,
                                          const Eigen::VectorXd* start, const Tangent*) const {
    if (has_free_coordinates(action)) return equilibrium_with_free_tools(*this, setting, action, start, nullptr);
    const skeleton::Load load = impl_->load(action);
    const skeleton::FibreStates& before = fibres_before(action);
    fem::Effects effects = impl_->effects(setting, action);
    const auto settle = [&](const Eigen::VectorXd* near) -> Eigen::VectorXd {
        skeleton::StaticsSolver solver(impl_->model(setting), effects);
        if (!in_large_rotation(setting)) return solver.solve(stiffness(setting), load, {}, nullptr, before).step;
        std::optional<State> from;
        if (near) from = unpack(*near);
        return pack(solver.solve(stiffness(setting), load, {}, from ? &*from : nullptr, before).state);
    };
    if (!rub(effects.tendons)) return settle(start);
    const auto with_held = [&](const std::vector<fem::TendonPull>& tendons, const Eigen::VectorXd* near) {
        effects.tendons = tendons;
        return settle(near);
    };
    const auto friction = [&](const fem::TendonPull& pull, const Eigen::VectorXd& q) {
        return skeleton::PlacedTendon(impl_->model(setting), pull).friction(impl_->equilibrium_of(q, setting).state);
    };
    return FrictionIteration(effects.tendons, with_held, friction).equilibrium(rest(setting), start);
}

Eigen::VectorXd SkeletonBody::residual(const Eigen::VectorXd& q, const ModelSetting& setting,
                                       const Action& action) const {
    if (has_free_coordinates(action)) return residual(q, setting, posed(*this, q, setting, action));
    const skeleton::Model& model = impl_->model(setting);
    const Equilibrium at = impl_->equilibrium_of(q, setting, action);
    fem::Effects in_force = impl_->effects(setting, action);
    const bool linear = !in_large_rotation(setting);
    if (linear) impl_->hold_friction(at.state, in_force);
    const skeleton::PlacedEffects effects(model, in_force);
    Eigen::VectorXd net = skeleton::external_force(model, impl_->tangent_state(q, setting), impl_->load(action)) +
                          skeleton::link_forces(model, at, in_force) * stiffness(setting);
    if (!effects.empty()) net += linear ? effects.linear_force(q) : effects.force(at.state);
    return net;
}

std::shared_ptr<const Tangent> SkeletonBody::tangent(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                     const Action& action) const {
    if (has_free_coordinates(action)) return tangent_with_free_tools(*this, q, setting, action);
    const fem::Effects effects = impl_->effects(setting, action);
    auto held = std::make_shared<SolverTangent>(impl_->model(setting), effects, stiffness(setting), impl_->load(action),
                                                impl_->equilibrium_of(q, setting, action));
    return tangent_with_friction(std::move(held), impl_->sliding(q, setting, effects));
}

Eigen::MatrixXd SkeletonBody::parameter_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                              const Action& action) const {
    if (has_free_coordinates(action)) return parameter_force(q, setting, posed(*this, q, setting, action));
    // by the logarithm of a multiplier: the force of that kind of stiffness itself
    const Eigen::SparseMatrix<double> G =
        skeleton::link_forces(impl_->model(setting), impl_->equilibrium_of(q, setting, action), setting.effects);
    const Eigen::VectorXd k = stiffness(setting);
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(k.size(), std::ssize(impl_->parameters));
    for (Eigen::Index place = 0; place < k.size(); ++place) {
        const int kind = impl_->parameter_of[place];
        if (kind >= 0) own(place, kind) = k[place];
    }
    // What tools press through is a share of Young's modulus, which goes with the mean of all logarithms.
    const Eigen::VectorXd grip = impl_->grip_force(q, setting, action) / static_cast<double>(own.cols());
    return (G * own).colwise() + grip;
}

Points SkeletonBody::observe(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observe(impl_->model(setting), impl_->equilibrium_of(q, setting),
                             impl_->grown(impl_->markers, setting));
}

Eigen::SparseMatrix<double> SkeletonBody::observation(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observation_jacobian(impl_->model(setting), impl_->equilibrium_of(q, setting),
                                          impl_->grown(impl_->markers, setting));
}

Eigen::VectorXd SkeletonBody::advance(const Eigen::VectorXd& q, const Eigen::VectorXd& step,
                                      const ModelSetting& setting) const {
    return in_large_rotation(setting) ? pack(skeleton::advance(unpack(q), step)) : Eigen::VectorXd(q + step);
}

std::shared_ptr<const Memory> SkeletonBody::remember(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                     const Action& action) const {
    if (!setting.effects.remember()) return nullptr;
    if (has_free_coordinates(action)) return remember(q, setting, posed(*this, q, setting, action));
    return std::make_shared<FibreMemory>(
        skeleton::flowed(impl_->model(setting), impl_->equilibrium_of(q, setting, action), setting.effects));
}

Eigen::VectorXd SkeletonBody::contact_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                            const mesh::Contact& contact) const {
    return skeleton::external_force(impl_->model(setting), impl_->tangent_state(q, setting),
                                    impl_->load({.contacts = {contact}}));
}

Vec3 SkeletonBody::normal_near(const Vec3& point, double radius) const {
    const mesh::Surface& skin = impl_->by_law[0].surface;
    return skin.triangles.rows() > 0 ? mesh::mean_normal(skin, point, radius) : Vec3(Vec3::UnitZ());
}

Eigen::RowVectorXd SkeletonBody::Impl::weight_of(const skeleton::StiffnessOrder& order, Eigen::Index place,
                                                 const Eigen::MatrixXd& W) const {
    const int owner = order.owner(place);
    if (order.kind(place) != skeleton::Stiffness::volume) return W.row(owner);
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(W.cols());
    int links = 0;
    for (Eigen::Index l = 0; l < std::ssize(by_law[0].links); ++l) {
        if (by_law[0].links[l].a != owner && by_law[0].links[l].b != owner) continue;
        sum += W.row(l);
        ++links;
    }
    return sum / std::max(links, 1);
}

const Points& SkeletonBody::pieces() const { return impl_->centres; }
const std::vector<char>& SkeletonBody::pieces_at_support() const { return impl_->at_support; }

Eigen::MatrixXd SkeletonBody::piece_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                          const Eigen::MatrixXd& W) const {
    Eigen::MatrixXd weighted(impl_->k0.size(), W.cols());
    const Eigen::VectorXd k = stiffness(setting);
    const skeleton::StiffnessOrder order(impl_->model(setting));
    for (Eigen::Index place = 0; place < weighted.rows(); ++place) {
        // a volume is as much harder as the links of its sphere are on average: the pieces are the links
        weighted.row(place) = k[place] * impl_->weight_of(order, place, W);
    }
    return skeleton::link_forces(impl_->model(setting), impl_->equilibrium_of(q, setting, action), setting.effects) *
           weighted;
}

const Points& SkeletonBody::skin() const { return impl_->by_law[0].surface.vertices; }
const Eigen::VectorXd& SkeletonBody::skin_areas() const { return impl_->skin_areas; }

Points SkeletonBody::skin_positions(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observe(impl_->model(setting), impl_->equilibrium_of(q, setting),
                             impl_->grown(impl_->by_law[0].skin, setting));
}

Eigen::SparseMatrix<double> SkeletonBody::skin_motion(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observation_jacobian(impl_->model(setting), impl_->equilibrium_of(q, setting),
                                          impl_->grown(impl_->by_law[0].skin, setting));
}

const Points& SkeletonBody::material_points() const { return impl_->spheres; }
const Eigen::VectorXd& SkeletonBody::material_shares() const { return impl_->mass_shares; }

Eigen::SparseMatrix<double> SkeletonBody::material_motion() const {
    std::vector<Eigen::Triplet<double>> ones;
    ones.reserve(static_cast<std::size_t>(impl_->spheres.size()));
    for (int s = 0; s < static_cast<int>(impl_->spheres.rows()); ++s) {
        for (int c = 0; c < 3; ++c) ones.emplace_back(3 * s + c, 6 * s + c, 1.0);
    }
    Eigen::SparseMatrix<double> result(impl_->spheres.size(), dofs());
    result.setFromTriplets(ones.begin(), ones.end());
    return result;
}

bool SkeletonBody::has_cavities() const { return impl_->has_cavities; }

const Points& SkeletonBody::support_points() const { return impl_->support_points; }
const Eigen::VectorXd& SkeletonBody::support_shares() const { return impl_->support_shares; }

Eigen::MatrixXd SkeletonBody::support_motion(const Vec3& centre) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(dofs(), 6);
    for (std::size_t s = 0; s < impl_->by_law[0].spheres.size(); ++s) {
        const skeleton::Sphere& sphere = impl_->by_law[0].spheres[s];
        if (!sphere.held) continue;
        const auto row = 6 * static_cast<Eigen::Index>(s);
        S.block<6, 6>(row, 0).setIdentity();
        S.block<3, 3>(row, 3) = -skeleton::skew(sphere.center - centre);
    }
    return S;
}

Eigen::MatrixXd SkeletonBody::tangent_times(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                            const Eigen::MatrixXd& steps) const {
    if (has_free_coordinates(action)) return tangent_times_with_free_tools(*this, q, setting, action, steps);
    skeleton::Model model = impl_->model(setting);
    skeleton::set_stiffness(model, stiffness(setting));
    const skeleton::Load load = in_large_rotation(setting) ? impl_->load(action) : skeleton::Load{};
    const fem::Effects effects = impl_->effects(setting, action);
    const fem::TendonSliding sliding = impl_->sliding(q, setting, effects);
    return skeleton::tangent(model, impl_->tangent_state(q, setting), load, effects, fibres_before(action)) * steps +
           sliding.by_number * (sliding.number_by_point * steps);
}

Eigen::VectorXd SkeletonBody::Impl::grip_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                               const Action& action) const {
    fem::Effects holding{.tendon_friction = setting.effects.tendon_friction};
    rig.add(action, young_of(setting), holding);
    holding.cavities.clear();
    std::erase_if(holding.tendons, [](const fem::TendonPull& pull) { return !pull.actuator->by_length; });
    if (holding.empty()) return Eigen::VectorXd::Zero(by_law[0].dofs());
    if (!in_large_rotation(setting)) hold_friction(equilibrium_of(q, setting).state, holding);
    const skeleton::PlacedEffects placed(model(setting), holding);
    return in_large_rotation(setting) ? placed.force(unpack(q)) : placed.linear_force(q);
}

template <class Visit>
void SkeletonBody::Impl::for_each_point_of(const mesh::ToolMotion& motion, const Eigen::VectorXd& q,
                                           const ModelSetting& setting, const Visit& visit) const {
    fem::Effects holding;
    holding.tools = {rig.tool(motion, young_of(setting))};
    const skeleton::PlacedEffects placed(model(setting), holding);
    placed.for_each_point_of_tool(0, tangent_state(q, setting),
                                  [&](const skeleton::CarriedPoint& at, fem::PointTerms terms) {
                                      Vec3 x = at.x();
                                      if (!in_large_rotation(setting)) {
                                          // As at rest, to first order.
                                          Vec3 moved = Vec3::Zero();
                                          for (int i = 0; i < at.shares(); ++i)
                                              moved += at.jacobian(i) * q.segment<6>(Eigen::Index{6} * at.sphere(i));
                                          x += moved;
                                          terms.gradient += terms.hessian * moved;
                                      }
                                      visit(at, x, terms);
                                  });
}

std::vector<mesh::ToolMotion> SkeletonBody::motions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                    const Action& action) const {
    return posed(*this, q, setting, action).motions;
}

Eigen::VectorXd SkeletonBody::reactions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                        const Action& action) const {
    if (has_free_coordinates(action)) return reactions(q, setting, posed(*this, q, setting, action));
    Eigen::VectorXd result = Eigen::VectorXd::Zero(6 * std::ssize(action.motions));
    for (std::size_t t = 0; t < action.motions.size(); ++t) {
        const Vec3 origin = impl_->rig.tool(action.motions[t], 1)->origin();
        impl_->for_each_point_of(action.motions[t], q, setting,
                                 [&](const skeleton::CarriedPoint&, const Vec3& x, const fem::PointTerms& terms) {
                                     result.segment<6>(static_cast<Eigen::Index>(6 * t)) +=
                                         fem::PointOnTool(terms, x - origin).wrench;
                                 });
    }
    return result;
}

ReactionSlopes SkeletonBody::reaction_slopes(const Eigen::VectorXd& q, const ModelSetting& setting,
                                             const Action& action) const {
    if (has_free_coordinates(action)) return reaction_slopes_with_free_tools(*this, q, setting, action);
    const Eigen::Index rows = 6 * std::ssize(action.motions), parameters = std::ssize(impl_->parameters);
    ReactionSlopes slopes{Eigen::MatrixXd::Zero(rows, dofs()), {}, Eigen::MatrixXd::Zero(rows, rows)};
    for (std::size_t t = 0; t < action.motions.size(); ++t) {
        const Vec3 origin = impl_->rig.tool(action.motions[t], 1)->origin();
        const auto row = static_cast<Eigen::Index>(6 * t);
        impl_->for_each_point_of(action.motions[t], q, setting,
                                 [&](const skeleton::CarriedPoint& at, const Vec3& x, const fem::PointTerms& terms) {
                                     const fem::PointOnTool part(terms, x - origin);
                                     slopes.by_pose.block<6, 6>(row, row) += part.wrench_by_pose;
                                     for (int i = 0; i < at.shares(); ++i)
                                         slopes.by_step.block<6, 6>(row, Eigen::Index{6} * at.sphere(i)) +=
                                             part.by_pose.transpose() * at.jacobian(i);
                                 });
    }
    // Young's modulus goes with the mean of all logarithms.
    slopes.by_parameter =
        reactions(q, setting, action) * Eigen::RowVectorXd::Constant(parameters, 1 / static_cast<double>(parameters));
    return slopes;
}

Eigen::MatrixXd SkeletonBody::actuation_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                              const Action& action) const {
    const skeleton::Model& model = impl_->model(setting);
    const State state = impl_->tangent_state(q, setting);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(dofs(), std::ssize(action.settings));
    for (std::size_t a = 0; a < action.settings.size(); ++a) {
        const mesh::ActuatorSetting& own = action.settings[a];
        Eigen::VectorXd column = Eigen::VectorXd::Zero(dofs());
        if (const auto& cavity = impl_->rig.cavity(own.actuator)) {
            skeleton::Cavities(model, *cavity).add_gradient(state, 1, column);
        } else {
            const skeleton::PlacedTendon tendon(
                model, impl_->rig.tendon(own, young(setting), setting.effects.tendon_friction));
            tendon.add(state, tendon.terms(state).by_value, -1, column);
        }
        result.col(static_cast<Eigen::Index>(a)) = column;
    }
    return result;
}

}  // namespace palpate::identify
