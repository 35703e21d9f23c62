#include "fem/large_deformation/body/loaded_body.h"

#include <algorithm>
#include <cmath>

namespace palpate::fem {

LoadedBody::LoadedBody(const BodyShape& body, const BodySetting& setting, const Eigen::VectorXd& f,
                       const MaterialState* before, double share, bool flows)
    : body_(body),
      material_(body, setting, before, flows),
      surface_(setting.effects.surface),
      share_(share),
      f_(share * f),
      pressures_(share * body.pressures(setting.effects)) {
    for (const auto& effect : setting.effects.points) {
        NodeWeights at = body.points(effect->acts_on(), setting.material.density);
        at.weights = effect->weights(body.mesh.nodes(at.nodes, Eigen::all), at.weights);
        if (effect->acts_on() != ActsOn::support) at.weights *= share;
        effects_.push_back({effect.get(), std::move(at)});
    }
    for (const auto& tool : setting.effects.tools) tools_.emplace_back(body, share == 1 ? tool : tool->part_way(share));
    for (const TendonPull& pull : setting.effects.tendons) {
        tendons_.emplace_back(body.tendon_paths->operator()(body.mesh, pull.actuator), pull.part(share),
                              material_.law() == MaterialLaw::linear);
    }
}

Eigen::VectorXd LoadedBody::grip(const Eigen::VectorXd& u) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(u.size());
    for (const PlacedTool& tool : tools_) tool.add_gradient(u, -1, sum);
    for (const PlacedTendon& tendon : tendons_)
        if (tendon.pull().actuator->by_length) tendon.add_gradient(u, -1, sum);
    return sum;
}

bool LoadedBody::may_part() const {
    return std::ranges::any_of(tools_, [](const PlacedTool& tool) { return tool.parts(); });
}

std::vector<NearPoint> LoadedBody::near_points(const Eigen::VectorXd& u) const {
    std::vector<NearPoint> points;
    int first = 0;
    for (const PlacedTool& tool : tools_)
        if (tool.parts()) first = tool.add_near_points(u, first, points);
    return points;
}

double LoadedBody::opening(const NearPoint& point, const Eigen::VectorXd& u) const {
    return (body_.displacements(u, point.at->element) * point.at->N).dot(point.normal);
}

void LoadedBody::add_push(const NearPoint& point, double times, Eigen::VectorXd& sum) const {
    body_.add(times * point.normal * point.at->N.transpose(), point.at->element, sum);
}

void LoadedBody::add_touch(const NearPoint& point, double times, const Unknowns& unknowns, LowerMatrix& K) const {
    ElementTangent tangent;
    for (auto& block : tangent.blocks) block.setZero();
    add_outer(times * point.stiffness * point.normal * point.normal.transpose(), *point.at, tangent);
    unknowns.add(point.at->element, tangent, K);
}

PointTerms LoadedBody::terms(const PlacedPotential& effect, std::size_t k, const Eigen::VectorXd& u) const {
    const int node = effect.at.nodes[k];
    const Vec3 X = body_.mesh.nodes.row(node), moved = u.segment<3>(std::int64_t(3) * node);
    if (material_.law() != MaterialLaw::linear || effect.potential->is_one_sided())
        return effect.potential->terms(X, X + moved);
    PointTerms at_rest = effect.potential->terms(X, X);
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
        const double energy = material_.force(u, e, f);
        if (!std::isfinite(energy)) return {energy, energy};
        sum.value += energy;
        body_.add(f, e, force);
    }
    // The distortion's energy is a small difference of large terms.
    sum.scale = std::abs(sum.value) + material_.energy_scale();
    for (const PlacedPotential& effect : effects_) {
        for (std::size_t k = 0; k < effect.at.nodes.size(); ++k) {
            const double weight = effect.at.weights(static_cast<Eigen::Index>(k));
            const PointTerms at = terms(effect, k, u);
            sum.value += weight * at.energy;
            sum.scale += std::abs(weight * at.energy);
            force.segment<3>(std::int64_t(3) * effect.at.nodes[k]) += weight * at.gradient;
        }
    }
    if (!pressures_.isZero(0)) {
        // -p (V - V0); in small strain a dead load, as on the body at rest.
        const Eigen::VectorXd rest = Eigen::VectorXd::Zero(u.size()), V0 = body_.cavities.volumes(rest);
        Eigen::VectorXd push = rest;
        const bool dead = material_.law() == MaterialLaw::linear;
        body_.cavities.add_gradient(dead ? rest : u, pressures_, push);
        const double more = dead ? push.dot(u) : pressures_.dot(body_.cavities.volumes(u) - V0);
        sum.value -= more;
        sum.scale += std::abs(more) + pressures_.cwiseAbs().dot(V0);
        force -= push;
    }
    const auto add = [&](double energy) {
        sum.value += energy;
        sum.scale += std::abs(energy);
    };
    if (!tools_.empty() || !tendons_.empty()) {
        Eigen::VectorXd holding = Eigen::VectorXd::Zero(u.size());
        for (const PlacedTool& tool : tools_) add(tool.add_gradient(u, 1, holding));
        for (const PlacedTendon& tendon : tendons_)
            add(tendon.add_gradient(u, 1, tendon.pull().actuator->by_length ? holding : force));
        sum.grip = holding.norm();
        force += holding;
    }
    if (!surface_.empty()) {
        const bool linear = material_.law() == MaterialLaw::linear;
        add(share_ * body_.skin().add_gradient(surface_, linear, u, share_, force));
    }
    add(-f_.dot(u));
    net = f_ - force;
    return sum;
}

double LoadedBody::rounding(const Eigen::VectorXd& u) const {
    double sum = material_.rounding(u);
    for (const PlacedTool& tool : tools_) sum = std::hypot(sum, tool.rounding());
    return sum;
}

bool LoadedBody::admits(const Eigen::VectorXd& u) const {
    Eigen::VectorXd net;
    return std::isfinite(potential(u, net).value);
}

Eigen::VectorXd LoadedBody::net_force(const Eigen::VectorXd& u) const {
    Eigen::VectorXd net;
    if (!std::isfinite(potential(u, net).value)) {
        for (std::size_t e = 0; e < body_.elements.size(); ++e) material_.force(u, e);
    }
    return net;
}

void LoadedBody::add_tangent(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const {
    ElementTangent tangent;
    for (std::size_t e = 0; e < body_.elements.size(); ++e) {
        material_.tangent(u, e, tangent);
        unknowns.add(static_cast<int>(e), tangent, K);
    }
    if (!pressures_.isZero(0) && material_.law() != MaterialLaw::linear)
        body_.cavities.add_hessian(u, -pressures_, unknowns, K);
    if (!surface_.empty())
        body_.skin().add_hessian(surface_, material_.law() == MaterialLaw::linear, u, share_, unknowns, K);
    for (const PlacedPotential& effect : effects_) {
        for (std::size_t k = 0; k < effect.at.nodes.size(); ++k) {
            const double weight = effect.at.weights(static_cast<Eigen::Index>(k));
            unknowns.add(effect.at.nodes[k], weight * terms(effect, k, u).hessian, K);
        }
    }
    for (const PlacedTool& tool : tools_) tool.add_hessian(u, unknowns, K);
    for (const PlacedTendon& tendon : tendons_) tendon.add_hessian(u, unknowns, K);
}

}  // namespace palpate::fem
