#include "fem/hyperelastic_body.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <numeric>

#include "fem/elements/restraint.h"
#include "fem/large_deformation/lazy.h"
#include "fem/large_deformation/solve/equilibrium.h"
#include "fem/large_deformation/solve/factored_tangent.h"

namespace palpate::fem {

namespace {

BodyShape shape_of(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation, ElementRegions regions) {
    assert(held.size() == static_cast<std::size_t>(mesh.nodes.rows()));
    std::vector<ElementShape> elements = element_shapes(mesh);
    check_restraint(mesh, held);
    NodeIntegrals integrals = node_integrals(mesh, held, regions);
    Cavities cavities(mesh);
    BodyShape shape{std::move(mesh),     std::move(held),      dilatation,
                    std::move(elements), std::move(integrals), std::move(cavities)};
    shape.regions = std::move(regions);
    return shape;
}

/// @throws InvalidInput for a material that is none.
void validate(const BodySetting& setting) {
    setting.material.validate();
    for (const Material& region : setting.regions) region.validate();
}

}  // namespace

struct HyperelasticBody::Impl {
    BodyShape shape;
    Solver solver;
    Impl(BodyShape body, Solver chosen) : shape(std::move(body)), solver(chosen) {}

    /// Which unknowns there are, and what couples them beyond elements.
    struct Kind {
        bool released;
        std::vector<std::shared_ptr<const mesh::TendonActuator>> tendons;
        auto operator<=>(const Kind&) const = default;
    };
    static Kind kind(const Effects& effects);
    JoinedNodes joined(const Kind& kind) const;

    // Each is made once.
    mutable std::mutex mutex;
    mutable std::map<Kind, Lazy<EliminationOrder>> orders;
    mutable std::map<Kind, Lazy<Unknowns>> all_nodes;  // in the mesh's order

    /// The unknowns that these effects leave.
    const EliminationOrder& order(const Effects& effects) const;
    /// All nodes, held ones too.
    const Unknowns& all(const Effects& effects) const;
    PlacedTendon placed(const TendonPull& pull, bool small_strain) const {
        return {(*shape.tendon_paths)(shape.mesh, pull.actuator), pull, small_strain};
    }
    /// The tangent over some unknowns. @throws SolverFailure where an element is inside out.
    LowerMatrix tangent(const Eigen::VectorXd& u, const BodySetting& setting, const MaterialState* before,
                        const Unknowns& unknowns) const;
};

HyperelasticBody::Impl::Kind HyperelasticBody::Impl::kind(const Effects& effects) {
    Kind result{release_supports(effects), {}};
    for (const TendonPull& pull : effects.tendons) result.tendons.push_back(pull.actuator);
    std::ranges::sort(result.tendons);
    return result;
}

JoinedNodes HyperelasticBody::Impl::joined(const Kind& kind) const {
    JoinedNodes result;
    for (const auto& tendon : kind.tendons) result.push_back((*shape.tendon_paths)(shape.mesh, tendon).nodes);
    return result;
}

const EliminationOrder& HyperelasticBody::Impl::order(const Effects& effects) const {
    const Kind own = kind(effects);
    const Lazy<EliminationOrder>& order = [&]() -> auto& {
        const std::scoped_lock lock(mutex);
        return orders[own];
    }
    ();
    return order.get([&] {
        return elimination_order(shape.mesh, own.released ? std::vector<char>(shape.held.size(), 0) : shape.held,
                                 joined(own), solver);
    });
}

const Unknowns& HyperelasticBody::Impl::all(const Effects& effects) const {
    Kind own = kind(effects);
    own.released = true;
    const Lazy<Unknowns>& unknowns = [&]() -> auto& {
        const std::scoped_lock lock(mutex);
        return all_nodes[own];
    }
    ();
    return unknowns.get([&] {
        std::vector<int> number(shape.held.size());
        std::iota(number.begin(), number.end(), 0);
        return Unknowns(shape.mesh, std::move(number), joined(own));
    });
}

HyperelasticBody::HyperelasticBody(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation,
                                   ElementRegions regions, Solver solver)
    : impl_(
          std::make_unique<Impl>(shape_of(std::move(mesh), std::move(held), dilatation, std::move(regions)), solver)) {}

HyperelasticBody::~HyperelasticBody() = default;
HyperelasticBody::HyperelasticBody(HyperelasticBody&&) noexcept = default;

const mesh::VolumeMesh& HyperelasticBody::mesh() const { return impl_->shape.mesh; }
const std::vector<char>& HyperelasticBody::held() const { return impl_->shape.held; }
NodeWeights HyperelasticBody::points(ActsOn what, double density) const { return impl_->shape.points(what, density); }
bool HyperelasticBody::has_cavities() const { return !impl_->shape.cavities.empty(); }
double HyperelasticBody::cavity_volume(const Eigen::VectorXd& u) const { return cavity_volumes(u).sum(); }
Eigen::VectorXd HyperelasticBody::cavity_volumes(const Eigen::VectorXd& u) const {
    return impl_->shape.cavities.volumes(u);
}
int HyperelasticBody::find_cavity(const mesh::PressureActuator& actuator) const {
    return impl_->shape.cavities.find(actuator);
}

Wrench HyperelasticBody::wrench(const Eigen::VectorXd& u, const std::shared_ptr<const ToolPotential>& tool) const {
    return PlacedTool(impl_->shape, tool).wrench(u);
}

Eigen::MatrixXd HyperelasticBody::wrench_derivative(const Eigen::VectorXd& u,
                                                    const std::shared_ptr<const ToolPotential>& tool) const {
    return PlacedTool(impl_->shape, tool).by_pose(u);
}

Eigen::Matrix<double, 6, 6> HyperelasticBody::wrench_by_pose(const Eigen::VectorXd& u,
                                                             const std::shared_ptr<const ToolPotential>& tool) const {
    return PlacedTool(impl_->shape, tool).wrench_by_pose(u);
}

Eigen::VectorXd HyperelasticBody::grip_forces(const Eigen::VectorXd& u, const BodySetting& setting) const {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    return LoadedBody(impl_->shape, setting, none).grip(u);
}

TendonState HyperelasticBody::tendon_state(const Eigen::VectorXd& u, const TendonPull& pull, bool small_strain) const {
    return impl_->placed(pull, small_strain).terms(u).state;
}

Eigen::MatrixXd HyperelasticBody::tendon_derivative(const Eigen::VectorXd& u, const TendonPull& pull,
                                                    bool small_strain) const {
    return impl_->placed(pull, small_strain).derivative(u);
}

Eigen::VectorXd HyperelasticBody::tendon_push(const Eigen::VectorXd& u, const TendonPull& pull,
                                              bool small_strain) const {
    return impl_->placed(pull, small_strain).push(u);
}

TendonFriction HyperelasticBody::tendon_friction(const Eigen::VectorXd& u, const TendonPull& pull,
                                                 bool small_strain) const {
    return impl_->placed(pull, small_strain).friction(u);
}

TendonSliding HyperelasticBody::tendon_sliding(const Eigen::VectorXd& u, const TendonPull& pull,
                                               bool small_strain) const {
    return impl_->placed(pull, small_strain).sliding(u);
}

Eigen::VectorXd HyperelasticBody::cavity_push(const Eigen::VectorXd& u, const mesh::PressureActuator& actuator,
                                              bool small_strain) const {
    const int cavity = find_cavity(actuator);
    Eigen::VectorXd push = Eigen::VectorXd::Zero(u.size());
    const Eigen::VectorXd one = Eigen::VectorXd::Unit(impl_->shape.cavities.count(), cavity);
    impl_->shape.cavities.add_gradient(small_strain ? Eigen::VectorXd(Eigen::VectorXd::Zero(u.size())) : u, one, push);
    return push;
}

double HyperelasticBody::potential(const Eigen::VectorXd& u, const BodySetting& setting, const Eigen::VectorXd& f,
                                   const MaterialState* before) const {
    validate(setting);
    Eigen::VectorXd net;
    return LoadedBody(impl_->shape, setting, f, before).potential(u, net).value;
}

Eigen::VectorXd HyperelasticBody::residual(const Eigen::VectorXd& u, const BodySetting& setting,
                                           const Eigen::VectorXd& f, const MaterialState* before) const {
    validate(setting);
    return LoadedBody(impl_->shape, setting, f, before).net_force(u);
}

LowerMatrix HyperelasticBody::Impl::tangent(const Eigen::VectorXd& u, const BodySetting& setting,
                                            const MaterialState* before, const Unknowns& unknowns) const {
    validate(setting);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    const LoadedBody body(shape, setting, none, before);
    body.net_force(u);  // refuses elements that are inside out
    LowerMatrix K = unknowns.zero();
    body.add_tangent(u, unknowns, K);
    return K;
}

Eigen::SparseMatrix<double> HyperelasticBody::tangent(const Eigen::VectorXd& u, const BodySetting& setting,
                                                      const MaterialState* before) const {
    const LowerMatrix K = impl_->tangent(u, setting, before, impl_->all(setting.effects));
    return LowerMatrix(K.selfadjointView<Eigen::Lower>());
}

std::shared_ptr<const BodyTangent> HyperelasticBody::factor(const Eigen::VectorXd& u, const BodySetting& setting,
                                                            const MaterialState* before) const {
    const EliminationOrder& order = impl_->order(setting.effects);
    return std::make_shared<FactoredTangent>(order, impl_->tangent(u, setting, before, order.unknowns));
}

Eigen::MatrixXd HyperelasticBody::modulus_forces(const Eigen::VectorXd& u, const BodySetting& setting,
                                                 const MaterialState* before) const {
    validate(setting);
    const ElementRegions& regions = impl_->shape.regions;
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(u.size(), Eigen::Index{2} * (regions.count() + 1));
    BodyMaterial material(impl_->shape, setting, before);
    for (int modulus = 0; modulus < 2; ++modulus) {
        material.set_moduli(modulus == 0, modulus == 1);
        for (std::size_t e = 0; e < impl_->shape.elements.size(); ++e) {
            const auto column = static_cast<Eigen::Index>(2 * regions.group(e)) + modulus;
            impl_->shape.add(material.force(u, e), e, forces.col(column));
        }
    }
    return forces;
}

Eigen::MatrixXd HyperelasticBody::element_forces(const Eigen::VectorXd& u, const BodySetting& setting,
                                                 const Eigen::MatrixXd& W, const MaterialState* before) const {
    assert(W.rows() == impl_->shape.mesh.tetrahedra.rows());
    validate(setting);
    const BodyMaterial material(impl_->shape, setting, before);
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(u.size(), W.cols());
    for (std::size_t e = 0; e < impl_->shape.elements.size(); ++e) {
        const NodeVectors f = material.force(u, e);
        for (Eigen::Index j = 0; j < W.cols(); ++j) {
            const double weight = W(static_cast<Eigen::Index>(e), j);
            if (weight != 0) impl_->shape.add(weight * f, e, forces.col(j));
        }
    }
    return forces;
}

BodyEquilibrium HyperelasticBody::equilibrium(const BodySetting& setting, const Eigen::VectorXd& f,
                                              const NewtonOptions& options, const Eigen::VectorXd* start,
                                              const MaterialState* before, const BodyTangent* guide) const {
    validate(setting);
    options.validate();
    const EliminationOrder& order = impl_->order(setting.effects);
    const auto* nearby = dynamic_cast<const FactoredTangent*>(guide);
    const TangentSolver* factor = nearby && nearby->is_in(order) ? &nearby->solver() : nullptr;
    return find_equilibrium(impl_->shape, order, setting, f, options, start, before, factor);
}

std::shared_ptr<const MaterialState> HyperelasticBody::state_after(const Eigen::VectorXd& u, const BodySetting& setting,
                                                                   const MaterialState* before) const {
    validate(setting);
    if (!setting.effects.remember()) return nullptr;
    return std::make_shared<MaterialState>(BodyMaterial(impl_->shape, setting, before).after(u));
}

}  // namespace palpate::fem
