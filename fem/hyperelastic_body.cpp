#include "fem/hyperelastic_body.h"

#include <cassert>
#include <mutex>
#include <numeric>

#include "fem/large_deformation/equilibrium.h"
#include "fem/large_deformation/factored_tangent.h"
#include "fem/solve/restraint.h"

namespace palpate::fem {

namespace {

/// Something made when it is first asked for, by whichever thread.
template <class Value>
class Lazy {
public:
    template <class Make>
    const Value& get(Make&& make) const {
        std::call_once(once_, [&] { value_ = std::make_unique<const Value>(make()); });
        return *value_;
    }

private:
    mutable std::once_flag once_;
    mutable std::unique_ptr<const Value> value_;
};

BodyShape shape_of(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation) {
    assert(held.size() == static_cast<std::size_t>(mesh.nodes.rows()));
    std::vector<ElementShape> elements = element_shapes(mesh);
    check_restraint(mesh, held);
    NodeIntegrals integrals = node_integrals(mesh, held);
    return {std::move(mesh), std::move(held), dilatation, std::move(elements), std::move(integrals)};
}

}  // namespace

struct HyperelasticBody::Impl {
    BodyShape shape;
    EliminationOrder held_order;
    Lazy<EliminationOrder> released_order;
    Lazy<Unknowns> all_nodes;  // in the mesh's order

    explicit Impl(BodyShape body) : shape(std::move(body)), held_order(elimination_order(shape.mesh, shape.held)) {}

    /// The unknowns that these effects leave.
    const EliminationOrder& order(const Potentials& effects) const {
        if (!release_supports(effects)) return held_order;
        return released_order.get(
            [&] { return elimination_order(shape.mesh, std::vector<char>(shape.held.size(), 0)); });
    }
    /// The tangent over some unknowns. @throws SolverFailure where an element is inside out.
    LowerMatrix tangent(const Eigen::VectorXd& u, const BodySetting& setting, const Unknowns& unknowns) const;
};

HyperelasticBody::HyperelasticBody(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation)
    : impl_(std::make_unique<Impl>(shape_of(std::move(mesh), std::move(held), dilatation))) {}

HyperelasticBody::~HyperelasticBody() = default;
HyperelasticBody::HyperelasticBody(HyperelasticBody&&) noexcept = default;

const mesh::VolumeMesh& HyperelasticBody::mesh() const { return impl_->shape.mesh; }
const std::vector<char>& HyperelasticBody::held() const { return impl_->shape.held; }
NodeWeights HyperelasticBody::points(ActsOn what, double density) const { return impl_->shape.points(what, density); }

double HyperelasticBody::potential(const Eigen::VectorXd& u, const BodySetting& setting,
                                   const Eigen::VectorXd& f) const {
    setting.material.validate();
    Eigen::VectorXd net;
    return LoadedBody(impl_->shape, setting, f).potential(u, net).value;
}

Eigen::VectorXd HyperelasticBody::residual(const Eigen::VectorXd& u, const BodySetting& setting,
                                           const Eigen::VectorXd& f) const {
    setting.material.validate();
    return LoadedBody(impl_->shape, setting, f).net_force(u);
}

LowerMatrix HyperelasticBody::Impl::tangent(const Eigen::VectorXd& u, const BodySetting& setting,
                                            const Unknowns& unknowns) const {
    setting.material.validate();
    const LoadedBody body(shape, setting, Eigen::VectorXd::Zero(u.size()));
    body.net_force(u);  // refuses elements that are inside out
    LowerMatrix K = unknowns.zero();
    body.add_tangent(u, unknowns, K);
    return K;
}

Eigen::SparseMatrix<double> HyperelasticBody::tangent(const Eigen::VectorXd& u, const BodySetting& setting) const {
    const Unknowns& unknowns = impl_->all_nodes.get([&] {
        std::vector<int> number(impl_->shape.held.size());
        std::iota(number.begin(), number.end(), 0);
        return Unknowns(impl_->shape.mesh, std::move(number));
    });
    const LowerMatrix K = impl_->tangent(u, setting, unknowns);
    return LowerMatrix(K.selfadjointView<Eigen::Lower>());
}

std::shared_ptr<const BodyTangent> HyperelasticBody::factor(const Eigen::VectorXd& u,
                                                            const BodySetting& setting) const {
    const EliminationOrder& order = impl_->order(setting.effects);
    return std::make_shared<FactoredTangent>(order, impl_->tangent(u, setting, order.unknowns));
}

Eigen::Matrix<double, Eigen::Dynamic, 2> HyperelasticBody::modulus_forces(const Eigen::VectorXd& u,
                                                                          const BodySetting& setting) const {
    setting.material.validate();
    Eigen::Matrix<double, Eigen::Dynamic, 2> forces = Eigen::MatrixXd::Zero(u.size(), 2);
    for (int modulus = 0; modulus < 2; ++modulus) {
        ElementModel model(setting, impl_->shape.dilatation);
        model.mu = modulus == 0;
        model.K = modulus == 1;
        for (std::size_t e = 0; e < impl_->shape.elements.size(); ++e) {
            impl_->shape.add(internal_force(impl_->shape, model, u, e), e, forces.col(modulus));
        }
    }
    return forces;
}

Eigen::MatrixXd HyperelasticBody::element_forces(const Eigen::VectorXd& u, const BodySetting& setting,
                                                 const Eigen::MatrixXd& W) const {
    assert(W.rows() == impl_->shape.mesh.tetrahedra.rows());
    setting.material.validate();
    const ElementModel model(setting, impl_->shape.dilatation);
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(u.size(), W.cols());
    for (std::size_t e = 0; e < impl_->shape.elements.size(); ++e) {
        const NodeVectors f = internal_force(impl_->shape, model, u, e);
        for (Eigen::Index j = 0; j < W.cols(); ++j) {
            const double weight = W(static_cast<Eigen::Index>(e), j);
            if (weight != 0) impl_->shape.add(weight * f, e, forces.col(j));
        }
    }
    return forces;
}

Eigen::MatrixXd HyperelasticBody::effect_forces(const Eigen::VectorXd& u, const PointPotential& effect,
                                                double density) const {
    const auto at = [&](int node) {
        const Vec3 X = impl_->shape.mesh.nodes.row(node);
        return effect.terms(X, X + u.segment<3>(std::int64_t(3) * node), true).by_parameter;
    };
    const NodeWeights acts_on = points(effect.acts_on(), density);
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(u.size(), at(0).cols());
    for (std::size_t k = 0; k < acts_on.nodes.size(); ++k) {
        const int node = acts_on.nodes[k];
        forces.middleRows<3>(std::int64_t(3) * node) -= acts_on.weights(static_cast<Eigen::Index>(k)) * at(node);
    }
    return forces;
}

BodyEquilibrium HyperelasticBody::equilibrium(const BodySetting& setting, const Eigen::VectorXd& f,
                                              const NewtonOptions& options, const Eigen::VectorXd* start) const {
    setting.material.validate();
    options.validate();
    return find_equilibrium(impl_->shape, impl_->order(setting.effects), setting, f, options, start);
}

}  // namespace palpate::fem
