#include "fem/hyperelastic_body.h"

#include <cassert>
#include <numeric>

#include "fem/elements/restraint.h"
#include "fem/large_deformation/lazy.h"
#include "fem/large_deformation/solve/equilibrium.h"
#include "fem/large_deformation/solve/factored_tangent.h"

namespace palpate::fem {

namespace {

BodyShape shape_of(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation) {
    assert(held.size() == static_cast<std::size_t>(mesh.nodes.rows()));
    std::vector<ElementShape> elements = element_shapes(mesh);
    check_restraint(mesh, held);
    NodeIntegrals integrals = node_integrals(mesh, held);
    Cavities cavities(mesh);
    return {std::move(mesh),     std::move(held),      dilatation,
            std::move(elements), std::move(integrals), std::move(cavities)};
}

}  // namespace

struct HyperelasticBody::Impl {
    BodyShape shape;
    Lazy<EliminationOrder> held_order, released_order;
    Lazy<Unknowns> all_nodes;  // in the mesh's order

    explicit Impl(BodyShape body) : shape(std::move(body)) {}

    /// The unknowns that these effects leave.
    const EliminationOrder& order(const Effects& effects) const {
        if (!release_supports(effects))
            return held_order.get([&] { return elimination_order(shape.mesh, shape.held); });
        return released_order.get(
            [&] { return elimination_order(shape.mesh, std::vector<char>(shape.held.size(), 0)); });
    }
    /// The tangent over some unknowns. @throws SolverFailure where an element is inside out.
    LowerMatrix tangent(const Eigen::VectorXd& u, const BodySetting& setting, const PlasticState* before,
                        const Unknowns& unknowns) const;
};

HyperelasticBody::HyperelasticBody(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation)
    : impl_(std::make_unique<Impl>(shape_of(std::move(mesh), std::move(held), dilatation))) {}

HyperelasticBody::~HyperelasticBody() = default;
HyperelasticBody::HyperelasticBody(HyperelasticBody&&) noexcept = default;

const mesh::VolumeMesh& HyperelasticBody::mesh() const { return impl_->shape.mesh; }
const std::vector<char>& HyperelasticBody::held() const { return impl_->shape.held; }
NodeWeights HyperelasticBody::points(ActsOn what, double density) const { return impl_->shape.points(what, density); }
bool HyperelasticBody::has_cavities() const { return !impl_->shape.cavities.empty(); }
double HyperelasticBody::cavity_volume(const Eigen::VectorXd& u) const { return impl_->shape.cavities.volume(u); }

double HyperelasticBody::potential(const Eigen::VectorXd& u, const BodySetting& setting, const Eigen::VectorXd& f,
                                   const PlasticState* before) const {
    setting.material.validate();
    Eigen::VectorXd net;
    return LoadedBody(impl_->shape, setting, f, before).potential(u, net).value;
}

Eigen::VectorXd HyperelasticBody::residual(const Eigen::VectorXd& u, const BodySetting& setting,
                                           const Eigen::VectorXd& f, const PlasticState* before) const {
    setting.material.validate();
    return LoadedBody(impl_->shape, setting, f, before).net_force(u);
}

LowerMatrix HyperelasticBody::Impl::tangent(const Eigen::VectorXd& u, const BodySetting& setting,
                                            const PlasticState* before, const Unknowns& unknowns) const {
    setting.material.validate();
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    const LoadedBody body(shape, setting, none, before);
    body.net_force(u);  // refuses elements that are inside out
    LowerMatrix K = unknowns.zero();
    body.add_tangent(u, unknowns, K);
    return K;
}

Eigen::SparseMatrix<double> HyperelasticBody::tangent(const Eigen::VectorXd& u, const BodySetting& setting,
                                                      const PlasticState* before) const {
    const Unknowns& unknowns = impl_->all_nodes.get([&] {
        std::vector<int> number(impl_->shape.held.size());
        std::iota(number.begin(), number.end(), 0);
        return Unknowns(impl_->shape.mesh, std::move(number));
    });
    const LowerMatrix K = impl_->tangent(u, setting, before, unknowns);
    return LowerMatrix(K.selfadjointView<Eigen::Lower>());
}

std::shared_ptr<const BodyTangent> HyperelasticBody::factor(const Eigen::VectorXd& u, const BodySetting& setting,
                                                            const PlasticState* before) const {
    const EliminationOrder& order = impl_->order(setting.effects);
    return std::make_shared<FactoredTangent>(order, impl_->tangent(u, setting, before, order.unknowns));
}

Eigen::Matrix<double, Eigen::Dynamic, 2> HyperelasticBody::modulus_forces(const Eigen::VectorXd& u,
                                                                          const BodySetting& setting,
                                                                          const PlasticState* before) const {
    setting.material.validate();
    Eigen::Matrix<double, Eigen::Dynamic, 2> forces = Eigen::MatrixXd::Zero(u.size(), 2);
    BodyMaterial material(impl_->shape, setting, before);
    for (int modulus = 0; modulus < 2; ++modulus) {
        material.set_moduli(modulus == 0, modulus == 1);
        for (std::size_t e = 0; e < impl_->shape.elements.size(); ++e) {
            impl_->shape.add(material.force(u, e), e, forces.col(modulus));
        }
    }
    return forces;
}

Eigen::MatrixXd HyperelasticBody::element_forces(const Eigen::VectorXd& u, const BodySetting& setting,
                                                 const Eigen::MatrixXd& W, const PlasticState* before) const {
    assert(W.rows() == impl_->shape.mesh.tetrahedra.rows());
    setting.material.validate();
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
                                              const PlasticState* before, const BodyTangent* guide) const {
    setting.material.validate();
    options.validate();
    const EliminationOrder& order = impl_->order(setting.effects);
    const auto* nearby = dynamic_cast<const FactoredTangent*>(guide);
    const Cholesky* factor = nearby && nearby->is_in(order) ? &nearby->factor() : nullptr;
    return find_equilibrium(impl_->shape, order, setting, f, options, start, before, factor);
}

std::shared_ptr<const PlasticState> HyperelasticBody::plastic_state(const Eigen::VectorXd& u,
                                                                    const BodySetting& setting,
                                                                    const PlasticState* before) const {
    setting.material.validate();
    if (!setting.effects.plasticity) return nullptr;
    return std::make_shared<PlasticState>(BodyMaterial(impl_->shape, setting, before).after(u));
}

}  // namespace palpate::fem
