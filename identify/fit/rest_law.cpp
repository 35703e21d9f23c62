#include "identify/fit/rest_law.h"

#include <algorithm>

#include "mesh/errors.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/solve/skeleton_system.h"

namespace palpate::identify {
namespace {

using Pairs = std::vector<std::array<int, 2>>;

/// Spheres that are free, in their order: those that effects release as well.
std::vector<int> free_spheres(const skeleton::Model& model, const fem::Effects& effects) {
    const skeleton::SkeletonSystem system(model, effects);
    std::vector<int> free;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (!system.body().spheres[i].held) free.push_back(i);
    }
    return free;
}

/// For each node its neighbours with a number not below its own, ascending.
std::vector<std::vector<int>> lower_neighbours(const Pairs& pairs, const std::vector<int>& number, std::size_t nodes) {
    std::vector<std::vector<int>> lower(nodes);
    for (std::size_t i = 0; i < nodes; ++i) lower[i].push_back(static_cast<int>(i));
    for (const auto& [a, b] : pairs) {
        const auto [low, high] = std::minmax(number[a], number[b]);
        if (low >= 0) lower[low].push_back(high);
    }
    for (std::vector<int>& rows : lower) {
        std::ranges::sort(rows);
        const auto rest = std::unique(rows.begin(), rows.end());
        rows.erase(rest, rows.end());
    }
    return lower;
}

/// Six columns for each node, with six rows for each neighbour; all zero.
fem::LowerMatrix room_for(const std::vector<std::vector<int>>& lower) {
    const auto size = static_cast<Eigen::Index>(6 * lower.size());
    fem::LowerMatrix K(size, size);
    std::int64_t* start = K.outerIndexPtr();
    start[0] = 0;
    for (Eigen::Index c = 0; c < size; ++c)
        start[c + 1] = start[c] + static_cast<std::int64_t>(6 * lower[c / 6].size());
    K.resizeNonZeros(start[size]);
    std::fill_n(K.valuePtr(), start[size], 0.0);
    std::int64_t* row = K.innerIndexPtr();
    for (Eigen::Index c = 0; c < size; ++c) {
        for (const int node : lower[c / 6]) {
            for (int i = 0; i < 6; ++i) *row++ = std::int64_t{6} * node + i;
        }
    }
    return K;
}

}  // namespace

RestLaw::RestLaw(const skeleton::Model& model)
    : model_(model), links_(std::make_shared<LinksAtRest>(model)), room_(std::make_shared<Room>()) {
    std::vector<int>& number = room_->number;
    number.assign(model.spheres.size(), -1);
    const fem::Effects physics = skeleton::physics_of(model.effects);
    const skeleton::PlacedEffects effects(model, physics);
    const std::vector<int> free = free_spheres(model, physics);
    for (std::size_t i = 0; i < free.size(); ++i) number[free[i]] = static_cast<int>(i);
    Pairs pairs = links_->ends;
    std::ranges::copy(effects.pairs(), std::back_inserter(pairs));
    std::ranges::copy(links_->placed.volumes().pairs(), std::back_inserter(pairs));

    fem::Elimination elimination = fem::analyse(lower_neighbours(pairs, number, free.size()), 6);
    for (const int i : free) number[i] = elimination.position[number[i]];
    room_->structure = std::make_shared<const fem::Supernodes>(std::move(elimination.supernodes));
    columns_ = lower_neighbours(pairs, number, free.size());
    K_0_ = room_for(columns_);

    const std::vector<Block> curvature = effects.curvature(effects.rest());
    for (std::size_t p = 0; p < curvature.size(); ++p) {
        add(effects.pairs()[p][0], effects.pairs()[p][1], curvature[p], K_0_.valuePtr());
    }
}

/// Adds a block at (a, b), and at (b, a) its transpose; of those what lies below the diagonal of blocks is stored.
void RestLaw::add(int a, int b, const Block& block, double* values) const {
    const int i = room_->number[a], j = room_->number[b], row = std::max(i, j), column = std::min(i, j);
    if (column < 0) return;
    const std::vector<int>& rows = columns_[column];
    const auto at = 6 * (std::ranges::lower_bound(rows, row) - rows.begin());
    const bool transposed = i < j;
    for (int c = 0; c < 6; ++c) {
        double* own = values + K_0_.outerIndexPtr()[6 * column + c] + at;
        for (int r = 0; r < 6; ++r) own[r] += transposed ? block(c, r) : block(r, c);
    }
}

Eigen::VectorXd RestLaw::values_at(const Eigen::VectorXd& k) const {
    const LinksAtRest& links = *links_;
    Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(K_0_.valuePtr(), K_0_.nonZeros());
    for (Eigen::Index l = 0; l < std::ssize(links.ends); ++l) {
        const Eigen::Index from = links.first[l], count = links.first[l + 1] - from;
        const skeleton::Stiffnesses own = links.order.link(k, l);
        Eigen::VectorXd weights = links.weights.segment(from, count);
        for (Eigen::Index j = 0; j < count; ++j) weights[j] *= own[links.kind[from + j]];
        const auto f = links.strains.middleCols(from, count);
        const skeleton::Mat12 H = (f * weights.asDiagonal()).lazyProduct(f.transpose());
        const auto& [a, b] = links.ends[l];
        add(a, a, H.topLeftCorner<6, 6>(), values.data());
        add(b, b, H.bottomRightCorner<6, 6>(), values.data());
        add(a, b, H.topRightCorner<6, 6>(), values.data());
    }
    const skeleton::PlacedVolumes& volumes = links.placed.volumes();
    if (volumes.empty()) return values;
    const std::vector<Block> blocks = volumes.curvature(k, links.state);
    for (std::size_t p = 0; p < blocks.size(); ++p) {
        add(volumes.pairs()[p][0], volumes.pairs()[p][1], blocks[p], values.data());
    }
    return values;
}

std::shared_ptr<const RestLaw::Factor> RestLaw::factor(const Eigen::VectorXd& k) const {
    auto result = std::make_shared<Factor>(room_);
    fem::LowerMatrix K = K_0_;
    Eigen::Map<Eigen::VectorXd>(K.valuePtr(), K.nonZeros()) = values_at(k);
    if (!result->factor_->factor(K)) {
        skeleton::StaticsSolver(model_).linear_steps(k, Eigen::MatrixXd::Zero(model_.dofs(), 1));  // says where
        throw SolverFailure("the model is singular to rounding: its stiffnesses lie too far apart");
    }
    return result;
}

RestLaw::Factor::Factor(std::shared_ptr<Room> room) : room_(std::move(room)) {
    {
        const std::scoped_lock lock(room_->mutex);
        if (!room_->idle.empty()) {
            factor_ = std::move(room_->idle.back());
            room_->idle.pop_back();
            return;
        }
    }
    factor_ = std::make_unique<fem::Cholesky>(room_->structure);
}

RestLaw::Factor::~Factor() {
    const std::scoped_lock lock(room_->mutex);
    room_->idle.push_back(std::move(factor_));
}

fem::Block RestLaw::Factor::solve(const fem::Block& F) const {
    const std::vector<int>& number = room_->number;
    fem::Block packed(room_->structure->size(), F.cols());
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] >= 0) packed.middleRows<6>(Eigen::Index{6} * number[i]) = F.middleRows<6>(6 * i);
    }
    factor_->solve(packed);
    fem::Block X = fem::Block::Zero(F.rows(), F.cols());
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] >= 0) X.middleRows<6>(6 * i) = packed.middleRows<6>(Eigen::Index{6} * number[i]);
    }
    return X;
}

}  // namespace palpate::identify
