#include "skeleton/effects/placed_effects.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/errors.h"
#include "skeleton/effects/tool_points.h"
#include "skeleton/model/attachment/carried_point.h"

namespace palpate::skeleton {

PlacedEffects::PlacedEffects(const Model& model, const fem::Effects& effects)
    : rest_(rest_state(model)),
      skin_(model, effects.surface),
      is_linear_(model.law == EquilibriumLaw::linear),
      supported_(model.spheres.size(), 0) {
    std::map<std::array<int, 2>, int> known;
    const auto pair = [&](int a, int b) {
        const auto [at, fresh] = known.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(pairs_.size()));
        if (fresh) pairs_.push_back(at->first);
        return at->second;
    };
    for (const auto& potential : effects.points) {
        const PointSet set = point_set(model, potential->acts_on());
        Points stand(std::ssize(set.at), 3);
        for (size_t i = 0; i < set.at.size(); ++i) {
            stand.row(static_cast<Eigen::Index>(i)) = set.at[i].rest;
        }
        place({potential, {}}, set, potential->weights(stand, set.weights), pair);
    }
    const double size = rest_.x.rows() > 0 ? (rest_.x.colwise().maxCoeff() - rest_.x.colwise().minCoeff()).norm() : 0;
    for (const auto& tool : effects.tools) {
        if (is_linear_ && tool->parts())
            throw SolverFailure(fmt::format(
                "The tool \"{}\" touches a skeleton and may part from it, which its linear law, an answer of one step, "
                "does not know: take the large-rotation law, or a bonded tool.",
                tool->tool().name));
        constexpr double barely_off = 1e-2;  // of the body's size: ten times what is left in balance, and more
        const PointSet set = tool_points(model, *tool);
        if (tool->parts()) {
            place({std::make_shared<const LayeredTool>(tool), {}, tool}, set, set.weights, pair);
        } else {
            place({tool, {}, tool, is_linear_ ? 0 : barely_off * size}, set, set.weights, pair);
        }
    }
    skin_.for_each_block(rest_, [&](int a, int b, const Block&) { skin_blocks_.push_back(pair(a, b)); });
    for (const fem::TendonPull& pull : effects.tendons) {
        tendons_.emplace_back(model, pull);
        std::vector<int>& blocks = tendon_blocks_.emplace_back();
        tendons_.back().for_each_block(rest_, 1, [&](int a, int b, const Block&) { blocks.push_back(pair(a, b)); });
    }
    if (effects.pressure != 0) place(effects.pressure, Cavities(model), pair);
    for (const fem::CavityPressure& own : effects.cavities) place(own.pressure, Cavities(model, *own.actuator), pair);
}

template <typename Pair>
void PlacedEffects::place(Placed effect, const PointSet& set, const Eigen::VectorXd& weights, const Pair& pair) {
    for (size_t i = 0; i < set.at.size(); ++i) {
        Point point{set.at[i], weights[static_cast<Eigen::Index>(i)], {}};
        for (const SphereInfluence& s : set.at[i].shares)
            for (const SphereInfluence& t : set.at[i].shares)
                if (s.sphere <= t.sphere) point.pairs.push_back(pair(s.sphere, t.sphere));
        effect.points.push_back(std::move(point));
        if (effect.potential->acts_on() == fem::ActsOn::support) supported_[set.at[i].shares.front().sphere] = 1;
    }
    effects_.push_back(std::move(effect));
}

template <typename Pair>
void PlacedEffects::place(double pressure, Cavities cavities, const Pair& pair) {
    if (cavities.empty())
        throw InvalidInput(
            "the model's skin encloses no cavity, in which a pressure could act: give it one, closed and turned "
            "inwards, "
            "or take the pressure away");
    PlacedPressure placed{pressure, std::move(cavities), {}};
    placed.cavities.for_each_pair([&](int a, int b) { placed.blocks.push_back(pair(a, b)); });
    cavities_.push_back(std::move(placed));
}

bool PlacedEffects::release_supports() const {
    return std::ranges::any_of(supported_, [](char s) { return s != 0; });
}

// Calls visit(effect, point, where it is, its terms, weight), the weight scaled; not for points that a tool does not
// touch.
template <typename Visit>
void PlacedEffects::for_each_point(const State& state, double share, const Visit& visit) const {
    for (const Placed& effect : effects_) {
        const bool whole = effect.tool || effect.potential->acts_on() == fem::ActsOn::support;
        const double scale = whole ? 1 : share;
        const auto potential = effect.tool && share != 1 ? effect.tool->part_way(share) : effect.potential;
        for (const Point& point : effect.points) {
            const fem::PointTerms terms = potential->terms(point.at.rest, carried_place(point.at, rest_, state));
            if (effect.tool && terms.hessian.isZero(0)) continue;
            visit(effect, point, CarriedPoint(point.at, rest_, state), terms, scale * point.weight);
        }
    }
}

PlacedEffects::Energy PlacedEffects::energy(const State& state, double share) const {
    Energy energy;
    const auto add = [&](double part, double size) {
        energy.sum += part;
        energy.size += std::abs(size);
    };
    for_each_point(state, share,
                   [&](const Placed&, const Point&, const CarriedPoint&, const fem::PointTerms& terms, double weight) {
                       add(weight * terms.energy, weight * terms.energy);
                   });
    if (!skin_.empty()) {
        const double of_skin = share * skin_.energy(state);
        add(of_skin, of_skin);
    }
    for (const PlacedTendon& tendon : tendons_) {
        const double of_tendon = tendon.terms(state, share).energy;
        add(of_tendon, of_tendon);
    }
    for (const auto& [pressure, cavities, blocks] : cavities_) {
        const double volume = cavities.volume(state);
        add(-share * pressure * (volume - cavities.rest_volume()), share * pressure * volume);
    }
    return energy;
}

Eigen::VectorXd PlacedEffects::force(const State& state, double share) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(6 * state.x.rows());
    for_each_point(state, share,
                   [&](const Placed&, const Point&, const CarriedPoint& at, const fem::PointTerms& terms,
                       double weight) { add_force(at, -weight * terms.gradient, f); });
    add_force_of_bodies(state, share, f);
    return f;
}

void PlacedEffects::add_force(const CarriedPoint& at, const Vec3& force, Eigen::VectorXd& f) {
    for (int i = 0; i < at.shares(); ++i)
        f.segment<6>(Eigen::Index{6} * at.sphere(i)) += at.jacobian(i).transpose() * force;
}

// Of what acts on more than single points.
void PlacedEffects::add_force_of_bodies(const State& state, double share, Eigen::VectorXd& f, bool cables) const {
    skin_.add_gradient(state, -share, f);
    for (const PlacedTendon& tendon : tendons_)
        if (cables || !tendon.pull().actuator->by_length) tendon.add(state, tendon.terms(state, share).gradient, -1, f);
    for (const auto& [pressure, cavities, blocks] : cavities_) cavities.add_gradient(state, share * pressure, f);
}

Eigen::VectorXd PlacedEffects::load_at_rest() const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(6 * rest_.x.rows());
    for_each_point(
        rest_, 1,
        [&](const Placed& effect, const Point&, const CarriedPoint& at, const fem::PointTerms& terms, double weight) {
            if (!effect.tool) add_force(at, -weight * terms.gradient, f);
        });
    add_force_of_bodies(rest_, 1, f, false);
    return f;
}

double PlacedEffects::load_of_tools(double length) const {
    double most = 0;
    for (const PlacedTendon& tendon : tendons_) {
        const fem::TendonPull& pull = tendon.pull();
        if (pull.actuator->by_length) most = std::max(most, pull.young * length * std::abs(pull.value));
    }
    for (const Placed& effect : effects_)
        if (effect.tool) most = std::max(most, effect.tool->young() * length * effect.tool->way());
    return most;
}

std::vector<PlacedEffects::Block> PlacedEffects::curvature(const State& state, double share) const {
    std::vector<Block> blocks(pairs_.size(), Block::Zero());
    for_each_point(state, share,
                   [&](const Placed& effect, const Point& point, const CarriedPoint& at, const fem::PointTerms& terms,
                       double weight) {
                       if (weight == 0) return;
                       // by the point's motion, and by how that motion turns
                       Eigen::MatrixXd turning = Eigen::MatrixXd::Zero(6 * at.shares(), 6 * at.shares());
                       if (terms.gradient.norm() < effect.turns_within) turning = at.curvature(weight * terms.gradient);
                       auto pair = point.pairs.begin();
                       for (int i = 0; i < at.shares(); ++i)
                           for (int j = 0; j < at.shares(); ++j) {
                               if (at.sphere(i) > at.sphere(j)) continue;
                               blocks[*pair++] +=
                                   at.jacobian(i).transpose() * (weight * terms.hessian) * at.jacobian(j) +
                                   turning.block<6, 6>(6 * i, 6 * j);
                           }
                   });
    auto of_skin = skin_blocks_.begin();
    skin_.for_each_block(state, [&](int, int, const Block& block) { blocks[*of_skin++] += share * block; });
    for (std::size_t t = 0; t < tendons_.size(); ++t) {
        auto next = tendon_blocks_[t].begin();
        tendons_[t].for_each_block(state, share, [&](int, int, const Block& block) { blocks[*next++] += block; });
    }
    if (is_linear_) return blocks;
    for (const PlacedPressure& own : cavities_) {
        auto next = own.blocks.begin();
        own.cavities.for_each_block(
            state, [&](int, int, const Block& block) { blocks[*next++] -= share * own.pressure * block; });
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
