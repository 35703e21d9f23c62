#include "skeleton/effects/placed_effects.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/errors.h"
#include "skeleton/model/carried_point.h"

namespace palpate::skeleton {

PlacedEffects::PlacedEffects(const Model& model, const fem::Effects& effects)
    : rest_(rest_state(model)),
      skin_(model, effects.surface),
      pressure_(effects.pressure),
      is_dead_(model.law == EquilibriumLaw::linear),
      supported_(model.spheres.size(), 0) {
    std::map<std::array<int, 2>, int> place;
    const auto pair = [&](int a, int b) {
        const auto [at, fresh] = place.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(pairs_.size()));
        if (fresh) pairs_.push_back(at->first);
        return at->second;
    };
    for (const auto& potential : effects.points) {
        const PointSet set = point_set(model, potential->acts_on());
        Points stand(std::ssize(set.at), 3);
        for (size_t i = 0; i < set.at.size(); ++i) {
            stand.row(static_cast<Eigen::Index>(i)) = set.at[i].rest;
        }
        const Eigen::VectorXd weights = potential->weights(stand, set.weights);
        Placed placed{potential, {}};
        for (size_t i = 0; i < set.at.size(); ++i) {
            Point point{set.at[i], weights[i], {}};
            for (const SphereInfluence& s : set.at[i].shares)
                for (const SphereInfluence& t : set.at[i].shares)
                    if (s.sphere <= t.sphere) point.pairs.push_back(pair(s.sphere, t.sphere));
            placed.points.push_back(std::move(point));
            if (potential->acts_on() == fem::ActsOn::support) supported_[set.at[i].shares.front().sphere] = 1;
        }
        effects_.push_back(std::move(placed));
    }
    skin_.for_each_block(rest_, [&](int a, int b, const Block&) { skin_blocks_.push_back(pair(a, b)); });
    if (pressure_ == 0) return;
    cavities_ = Cavities(model);
    if (cavities_.empty())
        throw InvalidInput(
            "the model's skin encloses no cavity, in which a pressure could act: give it one, closed and turned "
            "inwards, "
            "or take the pressure away");
    cavities_.for_each_block(rest_, [&](int a, int b, const Block&) { cavity_blocks_.push_back(pair(a, b)); });
}

bool PlacedEffects::release_supports() const {
    return std::ranges::any_of(supported_, [](char s) { return s != 0; });
}

// Calls visit(point, where it is, its terms, weight), the weight scaled.
template <typename Visit>
void PlacedEffects::for_each_point(const State& state, double share, const Visit& visit) const {
    for (const Placed& effect : effects_) {
        const double scale = effect.potential->acts_on() == fem::ActsOn::support ? 1 : share;
        for (const Point& point : effect.points) {
            const CarriedPoint at(point.at, rest_, state);
            visit(point, at, effect.potential->terms(point.at.rest, at.x()), scale * point.weight);
        }
    }
}

PlacedEffects::Energy PlacedEffects::energy(const State& state, double share) const {
    Energy energy;
    for_each_point(state, share, [&](const Point&, const CarriedPoint&, const fem::PointTerms& terms, double weight) {
        energy.sum += weight * terms.energy;
        energy.size += std::abs(weight * terms.energy);
    });
    if (!skin_.empty()) {
        const double of_skin = share * skin_.energy(state);
        energy.sum += of_skin;
        energy.size += std::abs(of_skin);
    }
    if (pressure_ != 0) {
        const double volume = cavities_.volume(state);
        energy.sum -= share * pressure_ * (volume - cavities_.rest_volume());
        energy.size += std::abs(share * pressure_ * volume);
    }
    return energy;
}

Eigen::VectorXd PlacedEffects::force(const State& state, double share) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(6 * state.x.rows());
    for_each_point(
        state, share, [&](const Point&, const CarriedPoint& at, const fem::PointTerms& terms, double weight) {
            for (int i = 0; i < at.shares(); ++i)
                f.segment<6>(Eigen::Index{6} * at.sphere(i)) -= at.jacobian(i).transpose() * (weight * terms.gradient);
        });
    skin_.add_gradient(state, -share, f);
    if (pressure_ != 0) cavities_.add_gradient(state, share * pressure_, f);
    return f;
}

std::vector<PlacedEffects::Block> PlacedEffects::curvature(const State& state, double share) const {
    std::vector<Block> blocks(pairs_.size(), Block::Zero());
    for_each_point(
        state, share, [&](const Point& point, const CarriedPoint& at, const fem::PointTerms& terms, double weight) {
            if (weight == 0) return;
            // by the point's motion, and by how that motion turns
            const Eigen::MatrixXd turning = at.curvature(weight * terms.gradient);
            auto pair = point.pairs.begin();
            for (int i = 0; i < at.shares(); ++i)
                for (int j = 0; j < at.shares(); ++j) {
                    if (at.sphere(i) > at.sphere(j)) continue;
                    blocks[*pair++] += at.jacobian(i).transpose() * (weight * terms.hessian) * at.jacobian(j) +
                                       turning.block<6, 6>(6 * i, 6 * j);
                }
        });
    auto of_skin = skin_blocks_.begin();
    skin_.for_each_block(state, [&](int, int, const Block& block) { blocks[*of_skin++] += share * block; });
    if (pressure_ != 0 && !is_dead_) {
        auto next = cavity_blocks_.begin();
        cavities_.for_each_block(state,
                                 [&](int, int, const Block& block) { blocks[*next++] -= share * pressure_ * block; });
    }
    return blocks;
}

Eigen::VectorXd PlacedEffects::linear_force(const Eigen::VectorXd& step) const {
    Eigen::VectorXd f = force(rest_);
    const std::vector<Block> blocks = curvature(rest_);
    for (size_t p = 0; p < pairs_.size(); ++p) {
        const Eigen::Index a = Eigen::Index{6} * pairs_[p][0], b = Eigen::Index{6} * pairs_[p][1];
        f.segment<6>(a) -= blocks[p] * step.segment<6>(b);
        if (a != b) f.segment<6>(b) -= blocks[p].transpose() * step.segment<6>(a);
    }
    return f;
}

}  // namespace palpate::skeleton
