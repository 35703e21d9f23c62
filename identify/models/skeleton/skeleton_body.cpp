#include "identify/models/skeleton/skeleton_body.h"

#include <cmath>
#include <mutex>

#include "identify/models/free_tools.h"
#include "identify/models/skeleton/skeleton_body_impl.h"
#include "identify/models/tendon_friction.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/model/attachment/attach.h"
#include "skeleton/model/stiffness_order.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

SkeletonBody::SkeletonBody(const skeleton::Model& model, const std::vector<Marker>& markers, double young,
                           const Rig& rig, double prior_sd, const std::vector<InformativePrior>& priors)
    : impl_(std::make_unique<Impl>(rig)) {
    Impl& i = *impl_;
    for (int law = 0; law < 2; ++law) {
        i.by_law[law] = model;
        i.by_law[law].effects.clear();
        i.by_law[law].law = static_cast<skeleton::EquilibriumLaw>(law);
        i.laws.emplace_back(skeleton::law_names[law]);
    }
    const skeleton::Attacher attach(model);
    for (const Marker& marker : markers) {
        i.markers.push_back(attach(marker.anchor.value_or(marker.rest), marker.rest));
    }
    i.k0 = skeleton::stiffness_vector(model);
    i.find_kinds(prior_sd, priors);
    i.young = young;
    i.geometry = geometry_of(model);
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
const BodyGeometry& SkeletonBody::geometry() const { return impl_->geometry; }
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
        std::optional<skeleton::State> from;
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
    const skeleton::Equilibrium at = impl_->equilibrium_of(q, setting, action);
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

}  // namespace palpate::identify
