#include "identify/models/reference/reference_body.h"

#include <algorithm>
#include <cmath>

#include "fem/elements/patch_load.h"
#include "identify/models/free_tools.h"
#include "identify/models/reference/reference_body_impl.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

constexpr const char* of_region = "young:";  // begins the name of a region's parameter

Points centres_of(const mesh::VolumeMesh& mesh) {
    Points centres(mesh.tetrahedra.rows(), 3);
    for (Eigen::Index e = 0; e < centres.rows(); ++e) {
        centres.row(e).setZero();
        for (int c = 0; c < 4; ++c) centres.row(e) += 0.25 * mesh.nodes.row(mesh.tetrahedra(e, c));
    }
    return centres;
}

/// The displacements of some nodes out of those of all (3 nodes x dofs).
Eigen::SparseMatrix<double> selection_of(const std::vector<int>& nodes, int dofs) {
    std::vector<Eigen::Triplet<double>> ones;
    ones.reserve(3 * nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (int c = 0; c < 3; ++c) ones.emplace_back(3 * static_cast<int>(i) + c, 3 * nodes[i] + c, 1.0);
    }
    Eigen::SparseMatrix<double> result(std::ssize(ones), dofs);
    result.setFromTriplets(ones.begin(), ones.end());
    return result;
}

/// Elements of which some nodes are held and some are not.
std::vector<char> cut_by_support(const mesh::VolumeMesh& mesh, const std::vector<char>& held) {
    std::vector<char> cut(mesh.tetrahedra.rows(), 0);
    for (std::size_t e = 0; e < cut.size(); ++e) {
        int count = 0;
        for (const int node : mesh.tetrahedra.row(static_cast<Eigen::Index>(e))) count += held[node] ? 1 : 0;
        cut[e] = count > 0 && count < mesh.tetrahedra.cols();
    }
    return cut;
}

}  // namespace

ReferenceBody::ReferenceBody(const mesh::VolumeMesh& mesh, const std::vector<mesh::Region>& supports,
                             const std::vector<Marker>& markers, const ReferenceBodyOptions& options) {
    impl_ = std::make_unique<Impl>(mesh, supports, markers, options);
    Impl& i = *impl_;
    BodyGeometry& geometry = i.geometry;
    geometry.has_cavities = i.body.has_cavities();
    geometry.surface = {mesh.nodes, mesh.faces.leftCols(3)};  // by the faces' corners
    geometry.pieces = centres_of(mesh);
    geometry.pieces_at_support = cut_by_support(mesh, i.body.held());
    const fem::NodeWeights support = i.body.points(fem::ActsOn::support, i.density);
    geometry.support_points = mesh.nodes(support.nodes, Eigen::all);
    geometry.support_shares = support.weights;
    const fem::NodeWeights skin = i.body.points(fem::ActsOn::surface, i.density);
    i.skin_nodes = skin.nodes;
    geometry.skin = mesh.nodes(skin.nodes, Eigen::all);
    geometry.skin_areas = skin.weights;
    const fem::NodeWeights material = i.body.points(fem::ActsOn::material, 1);
    i.material_nodes = material.nodes;
    geometry.material_points = mesh.nodes(material.nodes, Eigen::all);
    geometry.material_shares = material.weights / material.weights.sum();
    const double start = std::log(options.young.value_or(0.1));
    // Young's modulus to a factor of twenty. A ratio that is told is taken at its word, so that a fit which explains
    // little does not bend it (the effect `volume` contradicts it); else nu = .45, from about .13 to .49.
    const double compressibility = std::log(1 - 2 * options.poisson.value_or(0.45));
    // A choice within what require_material allows: wider than solids that are not made to be auxetic.
    constexpr double least_ratio = -0.5, most_ratio = 0.4999;
    constexpr double of_unknown = 4;   // tissues differ by more than bodies do, by a factor of 50
    constexpr double of_known = 1e-6;  // leaves nothing to be fitted
    i.parameters = {{"young", start, start, 3},
                    {"compressibility", compressibility, compressibility, options.poisson ? of_known : 1, false,
                     std::log(1 - 2 * most_ratio), std::log(1 - 2 * least_ratio)}};
    for (StiffnessParameter& parameter : i.parameters) {
        const InformativePrior* from_specimens = prior_of(parameter.name, parameter.prior_sd, options.priors);
        if (!from_specimens) continue;
        parameter.start = parameter.prior_mean = from_specimens->mean;
        parameter.prior_sd = from_specimens->sd;
    }
    for (const mesh::MaterialRegion& region : options.regions) {
        const double own = region.young ? std::log(*region.young) : start;
        i.parameters.push_back(
            {region_parameter(region.name), own, own, region.young ? of_known : of_unknown, !region.young});
    }
}

ReferenceBody::~ReferenceBody() = default;

Eigen::VectorXd ReferenceBody::Impl::shares_of(const mesh::Contact& contact) const {
    const Place place{contact.point.x(), contact.point.y(), contact.point.z(), contact.radius};
    {
        const std::scoped_lock lock(mutex);
        if (const auto found = shares.find(place); found != shares.end()) return found->second;
    }
    const Eigen::SparseMatrix<double> F =
        fem::patch_loads(body.mesh(), {{contact.point, Vec3::UnitX(), contact.radius}}, geometry.size);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(body.mesh().nodes.rows());
    for (Eigen::SparseMatrix<double>::InnerIterator it(F, 0); it; ++it) {
        if (it.row() % 3 == 0) result[it.row() / 3] = it.value();
    }
    const std::scoped_lock lock(mutex);
    shares.emplace(place, result);
    return result;
}

Eigen::VectorXd ReferenceBody::Impl::load(const Action& action) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(body.mesh().nodes.size());
    for (const mesh::Contact& contact : action.contacts) {
        if (contact.force.isZero(0)) continue;
        const Eigen::VectorXd share = shares_of(contact);
        for (int a = 0; a < 3; ++a) f(Eigen::seq(a, Eigen::last, 3)) += contact.force[a] * share;
    }
    if (!action.gravity.isZero(0)) {
        const fem::NodeWeights mass = body.points(fem::ActsOn::material, density);
        for (std::size_t k = 0; k < mass.nodes.size(); ++k) {
            f.segment<3>(Eigen::Index{3} * mass.nodes[k]) +=
                mass.weights[static_cast<Eigen::Index>(k)] * action.gravity;
        }
    }
    return f;
}

std::string region_parameter(const std::string& region) { return of_region + region; }

std::optional<std::string> region_of_parameter(const std::string& parameter) {
    if (!parameter.starts_with(of_region)) return std::nullopt;
    return parameter.substr(std::string_view(of_region).size());
}

int ReferenceBody::dofs() const { return static_cast<int>(impl_->body.mesh().nodes.size()); }
const std::vector<std::string>& ReferenceBody::laws() const { return impl_->laws; }
const std::vector<StiffnessParameter>& ReferenceBody::parameters() const { return impl_->parameters; }
const BodyGeometry& ReferenceBody::geometry() const { return impl_->geometry; }
double ReferenceBody::young(const ModelSetting& setting) const { return std::exp(setting.theta[ln_young]); }
bool ReferenceBody::is_nonlinear(const ModelSetting& setting) const {
    const bool one_sided =
        std::ranges::any_of(setting.effects.points, [](const auto& potential) { return potential->is_one_sided(); });
    return static_cast<fem::MaterialLaw>(setting.law) != fem::MaterialLaw::linear || setting.effects.remember() ||
           one_sided || impl_->rig.is_nonlinear();
}
const fem::HyperelasticBody& ReferenceBody::body() const { return impl_->body; }

fem::Material ReferenceBody::material(const ModelSetting& setting) const {
    return body_material(setting, impl_->density);
}

std::vector<fem::Material> ReferenceBody::region_materials(const ModelSetting& setting) const {
    return impl_->region_materials(setting, material(setting));
}

const std::vector<int>& ReferenceBody::region_of_element() const { return impl_->regions.of_element; }

Eigen::VectorXd ReferenceBody::rest(const ModelSetting&) const { return Eigen::VectorXd::Zero(dofs()); }

Eigen::VectorXd ReferenceBody::equilibrium(const ModelSetting& setting, const Action& action,
                                           const Eigen::VectorXd* start, const Tangent* guide) const {
    if (has_free_coordinates(action)) return equilibrium_with_free_tools(*this, setting, action, start, guide);
    // What is not found soon next to a known state is no answer for a trial.
    require_material(material(setting));
    const fem::NewtonOptions options{.tolerance = 1e-7, .iterations = start ? 40 : 60, .load_steps = start ? 0 : 16};
    const auto* nearby = guide ? dynamic_cast<const FemTangent*>(&with_friction_held(*guide)) : nullptr;
    fem::BodySetting own = impl_->setting(setting, action);
    const Eigen::VectorXd f = impl_->load(action);
    const auto settle = [&](const Eigen::VectorXd* from) {
        return impl_->body.equilibrium(own, f, options, from, memory_of(action), nearby ? &nearby->factor() : nullptr)
            .u;
    };
    if (!rub(own.effects.tendons)) return settle(start);
    const auto with_held = [&](const std::vector<fem::TendonPull>& tendons, const Eigen::VectorXd* from) {
        own.effects.tendons = tendons;
        return settle(from);
    };
    const auto friction = [&](const fem::TendonPull& pull, const Eigen::VectorXd& q) {
        return impl_->body.tendon_friction(q, pull, in_small_strain(setting));
    };
    return FrictionIteration(own.effects.tendons, with_held, friction).equilibrium(rest(setting), start);
}

Eigen::VectorXd ReferenceBody::residual(const Eigen::VectorXd& q, const ModelSetting& setting,
                                        const Action& action) const {
    if (has_free_coordinates(action)) return residual(q, setting, posed(*this, q, setting, action));
    return impl_->body.residual(q, impl_->setting(setting, action), impl_->load(action), memory_of(action));
}

std::shared_ptr<const Tangent> ReferenceBody::tangent(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                      const Action& action) const {
    require_material(material(setting));
    if (has_free_coordinates(action)) return tangent_with_free_tools(*this, q, setting, action);
    const fem::BodySetting own = impl_->setting(setting, action);
    auto held = std::make_shared<FemTangent>(impl_->body.factor(q, own, memory_of(action)));
    return tangent_with_friction(std::move(held), impl_->sliding(q, own));
}

Eigen::MatrixXd ReferenceBody::parameter_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                               const Action& action) const {
    if (has_free_coordinates(action)) return parameter_force(q, setting, posed(*this, q, setting, action));
    const fem::BodySetting own = impl_->setting(setting, action);
    const Eigen::MatrixXd unit = impl_->body.modulus_forces(q, own, memory_of(action));
    const auto of_body = slopes_of(own.material, unit.leftCols<2>());
    // The residual is minus the internal force. What tools press through is as many times as stiff as the body.
    Eigen::MatrixXd G(q.size(), std::ssize(impl_->parameters));
    G.col(ln_young) = impl_->body.grip_forces(q, own) - of_body.col(0);
    G.col(ln_compressibility) = -of_body.col(1);
    for (std::size_t r = 0; r < own.regions.size(); ++r) {
        const auto place = static_cast<Eigen::Index>(r);
        const auto of_region = slopes_of(own.regions[r], unit.middleCols<2>(2 * (place + 1)));
        G.col(first_region + place) = -of_region.col(0);
        if (!impl_->options.regions[r].poisson) G.col(ln_compressibility) -= of_region.col(1);
    }
    return G;
}

Points ReferenceBody::observe(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return impl_->frames.positions(q, in_small_strain(setting));
}

Eigen::SparseMatrix<double> ReferenceBody::observation(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return impl_->frames.derivative(q, in_small_strain(setting));
}

Eigen::VectorXd ReferenceBody::advance(const Eigen::VectorXd& q, const Eigen::VectorXd& step,
                                       const ModelSetting&) const {
    return q + step;
}

std::shared_ptr<const Memory> ReferenceBody::remember(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                      const Action& action) const {
    if (!setting.effects.remember()) return nullptr;
    if (has_free_coordinates(action)) return remember(q, setting, posed(*this, q, setting, action));
    return std::make_shared<FemMemory>(impl_->body.state_after(q, impl_->setting(setting, action), memory_of(action)));
}

Eigen::VectorXd ReferenceBody::contact_force(const Eigen::VectorXd&, const ModelSetting&,
                                             const mesh::Contact& contact) const {
    return impl_->load({.contacts = {contact}});
}

Eigen::MatrixXd ReferenceBody::piece_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                           const Eigen::MatrixXd& W) const {
    if (has_free_coordinates(action)) return piece_force(q, setting, posed(*this, q, setting, action), W);
    return -impl_->body.element_forces(q, impl_->setting(setting, action), W, memory_of(action));
}

Points ReferenceBody::skin_positions(const Eigen::VectorXd& q, const ModelSetting&) const {
    const Eigen::Map<const Points> u(q.data(), q.size() / 3, 3);
    return impl_->geometry.skin + Points(u(impl_->skin_nodes, Eigen::all));
}

Eigen::SparseMatrix<double> ReferenceBody::skin_motion(const Eigen::VectorXd&, const ModelSetting&) const {
    return selection_of(impl_->skin_nodes, dofs());
}

Eigen::SparseMatrix<double> ReferenceBody::material_motion() const {
    return selection_of(impl_->material_nodes, dofs());
}

Eigen::MatrixXd ReferenceBody::support_motion(const Vec3& centre) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(dofs(), 6);
    for (std::size_t node = 0; node < impl_->body.held().size(); ++node) {
        if (!impl_->body.held()[node]) continue;
        const auto row = 3 * static_cast<Eigen::Index>(node);
        const Vec3 arm = impl_->body.mesh().nodes.row(static_cast<Eigen::Index>(node)).transpose() - centre;
        S.block<3, 3>(row, 0).setIdentity();
        S.block<3, 3>(row, 3) = -skeleton::skew(arm);
    }
    return S;
}

}  // namespace palpate::identify
