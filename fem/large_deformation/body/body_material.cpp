#include "fem/large_deformation/body/body_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "fem/elements/shape.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

void validate(const Plasticity& plasticity) {
    if (!(plasticity.yield > 0)) {
        throw InvalidInput(fmt::format(
            "Plasticity: the strain of first yield (stress over 3 mu) is {}; allowed: more than 0.", plasticity.yield));
    }
    if (!(plasticity.hardening >= 0)) {
        throw InvalidInput(
            fmt::format("Plasticity: hardening (over 3 mu) is {}; allowed: 0 and more.", plasticity.hardening));
    }
}

void validate(const Damage& damage) {
    if (!(damage.share < 1)) {  // derivatives at 0 ask for a little less than that
        throw InvalidInput(
            fmt::format("Damage: the share of stress that it may take is {}; allowed: less than 1.", damage.share));
    }
    if (!(damage.strain > 0)) {
        throw InvalidInput(fmt::format("Damage: the strain that does it is {}; allowed: more than 0.", damage.strain));
    }
}

std::vector<ElementModel> models_of(const BodyShape& body, const BodySetting& setting) {
    assert(setting.regions.empty() || std::ssize(setting.regions) == body.regions.count());
    std::vector<ElementModel> models(static_cast<std::size_t>(body.regions.count() + 1), {setting, body.dilatation});
    for (std::size_t r = 0; r < setting.regions.size(); ++r) models[r + 1].take(setting.regions[r]);
    return models;
}

/// Of an element's corners at rest.
Vec3 middle(const BodyShape& body, std::size_t element) {
    const auto corners = body.mesh.tetrahedra.row(static_cast<Eigen::Index>(element)).head<4>();
    return body.mesh.nodes(corners, Eigen::all).colwise().mean();
}

Mat3 gradient_at(const ElementShape& shape, const NodeVectors& u, int q) {
    return Mat3::Identity() + u * shape.gradients(q).transpose();
}

}  // namespace

BodyMaterial::BodyMaterial(const BodyShape& body, const BodySetting& setting, const MaterialState* before, bool flows)
    : body_(body),
      models_(models_of(body, setting)),
      plasticity_(setting.effects.plasticity),
      damage_(setting.effects.damage),
      before_(before),
      flows_(flows) {
    if (plasticity_) validate(*plasticity_);
    if (damage_) validate(*damage_);
    if (const Growth& growth = setting.effects.growth; !growth.none()) {
        growth_.reserve(body.elements.size());
        for (std::size_t e = 0; e < body.elements.size(); ++e) growth_.push_back(growth.at(middle(body, e)));
    }
    assert(!before || (before->law == setting.law && before->points.size() == element_points * body.elements.size()));
    const auto& all = setting.effects.material;
    if (all.empty() && !plasticity_ && !damage_) return;
    for (const auto& effect : all) {
        if (!effect->is_scale()) energies_.push_back(effect.get());
    }

    place_.assign(body.elements.size(), -1);
    for (std::size_t e = 0; e < body.elements.size(); ++e) {
        ElementEffects own;
        own.energies = energies_;
        if (plasticity_) own.plasticity = &*plasticity_;
        if (damage_) own.damage = &*damage_;
        if (before_) own.before = &before_->points[element_points * e];
        own.flows = flows_;
        own.X = body.quadrature_points(e);
        for (int q = 0; q < element_points; ++q) {
            for (const auto& effect : all) own.s(q) *= effect->stiffness(own.X.row(q));
        }
        own.mean_s = body.elements[e].w.dot(own.s) / body.elements[e].w.sum();
        if (own.is_scale() && (own.s.array() == 1).all()) continue;
        place_[e] = static_cast<int>(effects_.size());
        effects_.push_back(own);
    }
}

NodeVectors BodyMaterial::elastic_displacements(const Eigen::VectorXd& u, std::size_t element) const {
    NodeVectors moved = body_.displacements(u, element);
    if (growth_.empty()) return moved;
    const double growth = growth_[element];
    // From its first node, as only differences count: (X + u) / g - X.
    NodeVectors X =
        node_positions<element_nodes>(body_.mesh.nodes, body_.mesh.tetrahedra.row(static_cast<Eigen::Index>(element)))
            .transpose();
    X.colwise() -= X.col(0).eval();
    if (law() == MaterialLaw::linear) return moved - growth * X;
    return (moved - growth * X) / (1 + growth);
}

double BodyMaterial::force(const Eigen::VectorXd& u, std::size_t element, NodeVectors& f) const {
    const double energy =
        element_force(body_.elements[element], model(element), effects(element), elastic_displacements(u, element), f);
    const double g = scale(element);
    f *= g * g;
    return g * g * g * energy;
}

NodeVectors BodyMaterial::force(const Eigen::VectorXd& u, std::size_t element) const {
    NodeVectors f;
    if (std::isfinite(force(u, element, f))) return f;
    const Vec3 at = middle(body_, element);
    throw SolverFailure(
        fmt::format("Element {} of the body, at rest near ({:.4g}, {:.4g}, {:.4g}) mm, is turned inside out by these "
                    "displacements; there it has no force. Take smaller displacements.",
                    element, at.x(), at.y(), at.z()));
}

void BodyMaterial::tangent(const Eigen::VectorXd& u, std::size_t element, ElementTangent& K) const {
    element_tangent(body_.elements[element], model(element), effects(element), elastic_displacements(u, element), K);
    if (growth_.empty()) return;
    const double g = scale(element);
    for (ElementTangent::NodePairs& block : K.blocks) block *= g;
}

MaterialState BodyMaterial::after(const Eigen::VectorXd& u) const {
    assert(plasticity_ || damage_);
    MaterialState result{law(), std::vector<MaterialPoint>(element_points * body_.elements.size())};
    for (std::size_t e = 0; e < body_.elements.size(); ++e) {
        force(u, e);  // refuses elements that are inside out
        const NodeVectors moved = elastic_displacements(u, e);
        for (int q = 0; q < element_points; ++q) {
            const std::size_t k = element_points * e + static_cast<std::size_t>(q);
            const MaterialPoint had = before_ ? before_->points[k] : MaterialPoint{};
            result.points[k] =
                material_point(law(), plasticity_, damage_, had, gradient_at(body_.elements[e], moved, q));
        }
    }
    return result;
}

double BodyMaterial::energy_scale() const {
    double energy = 0;
    for (std::size_t e = 0; e < body_.elements.size(); ++e) {
        const ElementEffects* own = effects(e);
        energy += (own ? own->mean_s : 1) * model(e).mu * body_.elements[e].w.sum();
    }
    return energy;
}

double BodyMaterial::rounding(const Eigen::VectorXd& u) const {
    // Small stresses are differences of terms as large as the moduli. The deformation gradient F = I + sum_i u_i dN_i
    // is itself a difference: where a thin element moves by many times its height its terms are far larger than F, and
    // each displacement is known to a share of its own size only. A stress of F S(F^T F) hands that on by |F|^2.
    double squares = 0;
    for (std::size_t e = 0; e < body_.elements.size(); ++e) {
        const ElementShape& shape = body_.elements[e];
        const ElementEffects* own = effects(e);
        const NodeVectors moved = body_.displacements(u, e);
        const auto reach = moved.colwise().squaredNorm();
        for (int q = 0; q < element_points; ++q) {
            const double terms = 1 + shape.gradients(q).colwise().squaredNorm().cwiseProduct(reach).sum();
            const double stretch = gradient_at(shape, moved, q).squaredNorm() / 3;
            const double mu = model(e).mu, K = model(e).K;
            double modulus = mu + K;
            if (own) {
                const Mat3 rest = Mat3::Identity();
                const double added = own->is_scale() ? 0 : own->added(law(), q, rest, true).second.norm();
                modulus = own->s(q) * (mu + K + mu * added);
            }
            squares += terms * std::max(1.0, stretch * stretch) * modulus * modulus *
                       (shape.w(q) * shape.gradients(q)).squaredNorm();
        }
    }
    return std::numeric_limits<double>::epsilon() * std::sqrt(squares);
}

}  // namespace palpate::fem
