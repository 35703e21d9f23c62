#include "fem/large_deformation/loaded_body.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "mesh/errors.h"

namespace palpate::fem {

NodeWeights BodyShape::points(ActsOn what, double density) const {
    const Eigen::VectorXd& all = what == ActsOn::material  ? integrals.volume
                                 : what == ActsOn::surface ? integrals.area
                                                           : integrals.support;
    const double factor = what == ActsOn::material ? density : 1;
    NodeWeights result;
    if (factor == 0) return result;
    for (Eigen::Index i = 0; i < all.size(); ++i) {
        if (all(i) != 0) result.nodes.push_back(static_cast<int>(i));
    }
    result.weights = factor * all(result.nodes);
    return result;
}

NodeVectors BodyShape::displacements(const Eigen::VectorXd& u, std::size_t element) const {
    const int* node = mesh.tetrahedra.data() + element * element_nodes;
    NodeVectors result;
    for (int i = 0; i < element_nodes; ++i) result.col(i) = u.segment<3>(std::int64_t(3) * node[i]);
    return result;
}

void BodyShape::add(const NodeVectors& f, std::size_t element, Eigen::Ref<Eigen::VectorXd> forces) const {
    const int* node = mesh.tetrahedra.data() + element * element_nodes;
    for (int i = 0; i < element_nodes; ++i) forces.segment<3>(std::int64_t(3) * node[i]) += f.col(i);
}

NodeVectors internal_force(const BodyShape& body, const ElementModel& model, const Eigen::VectorXd& u,
                           std::size_t element) {
    NodeVectors f;
    if (std::isfinite(element_force(body.elements[element], model, body.displacements(u, element), f))) return f;
    const auto corners = body.mesh.tetrahedra.row(static_cast<Eigen::Index>(element)).head<4>();
    const Vec3 at = body.mesh.nodes(corners, Eigen::all).colwise().mean();
    throw SolverFailure(
        fmt::format("Element {} of the body, at rest near ({:.4g}, {:.4g}, {:.4g}) mm, is turned inside out by these "
                    "displacements; there it has no force. Take smaller displacements.",
                    element, at.x(), at.y(), at.z()));
}

LoadedBody::LoadedBody(const BodyShape& body, const BodySetting& setting, const Eigen::VectorXd& f, double share)
    : body_(body), model_(setting, body.dilatation), f_(share * f) {
    for (const auto& effect : setting.effects) {
        effects_.push_back({effect.get(), body.points(effect->acts_on(), setting.material.density)});
        if (effect->acts_on() != ActsOn::support) effects_.back().at.weights *= share;
    }
}

PointTerms LoadedBody::terms(const Effect& effect, std::size_t k, const Eigen::VectorXd& u) const {
    const int node = effect.at.nodes[k];
    const Vec3 X = body_.mesh.nodes.row(node), moved = u.segment<3>(std::int64_t(3) * node);
    if (model_.law != Law::linear) return effect.potential->terms(X, X + moved, false);
    PointTerms at_rest = effect.potential->terms(X, X, false);
    const Vec3 change = at_rest.hessian * moved;
    at_rest.energy += (at_rest.gradient + change / 2).dot(moved);
    at_rest.gradient += change;
    return at_rest;
}

Potential LoadedBody::potential(const Eigen::VectorXd& u, Eigen::VectorXd& net) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(u.size());
    Potential sum;
    NodeVectors f;
    for (std::size_t e = 0; e < body_.elements.size(); ++e) {
        const double energy = element_force(body_.elements[e], model_, body_.displacements(u, e), f);
        if (!std::isfinite(energy)) return {energy, energy};
        sum.value += energy;
        body_.add(f, e, force);
    }
    // The distortion's energy is a small difference of large terms.
    sum.scale = std::abs(sum.value) + model_.mu * body_.integrals.volume.sum();
    for (const Effect& effect : effects_) {
        for (std::size_t k = 0; k < effect.at.nodes.size(); ++k) {
            const double weight = effect.at.weights(static_cast<Eigen::Index>(k));
            const PointTerms at = terms(effect, k, u);
            sum.value += weight * at.energy;
            sum.scale += std::abs(weight * at.energy);
            force.segment<3>(std::int64_t(3) * effect.at.nodes[k]) += weight * at.gradient;
        }
    }
    const double work = f_.dot(u);
    sum.value -= work;
    sum.scale += std::abs(work);
    net = f_ - force;
    return sum;
}

bool LoadedBody::admits(const Eigen::VectorXd& u) const {
    Eigen::VectorXd net;
    return std::isfinite(potential(u, net).value);
}

Eigen::VectorXd LoadedBody::net_force(const Eigen::VectorXd& u) const {
    Eigen::VectorXd net;
    if (!std::isfinite(potential(u, net).value)) {
        for (std::size_t e = 0; e < body_.elements.size(); ++e) internal_force(body_, model_, u, e);
    }
    return net;
}

double LoadedBody::rounding() const {
    // Small stresses are differences of terms as large as the moduli.
    double squares = 0;
    for (const ElementShape& shape : body_.elements) {
        for (int q = 0; q < element_points; ++q) {
            squares += (shape.w(q) * shape.gradients(q)).squaredNorm();
        }
    }
    return std::numeric_limits<double>::epsilon() * (model_.mu + model_.K) * std::sqrt(squares);
}

void LoadedBody::add_tangent(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const {
    ElementTangent tangent;
    for (std::size_t e = 0; e < body_.elements.size(); ++e) {
        element_tangent(body_.elements[e], model_, body_.displacements(u, e), tangent);
        unknowns.add(static_cast<int>(e), tangent, K);
    }
    for (const Effect& effect : effects_) {
        for (std::size_t k = 0; k < effect.at.nodes.size(); ++k) {
            const double weight = effect.at.weights(static_cast<Eigen::Index>(k));
            unknowns.add(effect.at.nodes[k], weight * terms(effect, k, u).hessian, K);
        }
    }
}

}  // namespace palpate::fem
