#include "identify/inference/domains/position/rest_law.h"

#include <algorithm>

#include "mesh/errors.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/statics/skeleton_system.h"

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

/// Pairs of spheres as pairs of free ones; -1: held.
Pairs numbered(const Pairs& pairs, const std::vector<int>& number) {
    Pairs result;
    for (const auto& [a, b] : pairs) result.push_back({number[a], number[b]});
    return result;
}

}  // namespace

LinearStatics::FactorPool::FactorPool(const std::vector<int>& free, const Pairs& pairs)
    : free(free), structure(static_cast<int>(free.size()), pairs) {}

LinearStatics::LinearStatics(const skeleton::Model& model)
    : model_(model), links_(std::make_shared<LinksAtRest>(model)), number_(model.spheres.size(), -1) {
    const fem::Effects physics = skeleton::physics_of(model.effects);
    const skeleton::PlacedEffects effects(model, physics);
    const std::vector<int> free = free_spheres(model, physics);
    for (std::size_t i = 0; i < free.size(); ++i) number_[free[i]] = static_cast<int>(i);
    Pairs pairs = links_->ends;
    std::ranges::copy(effects.pairs(), std::back_inserter(pairs));
    std::ranges::copy(links_->placed.volumes().pairs(), std::back_inserter(pairs));
    pool_ = std::make_shared<FactorPool>(free, numbered(pairs, number_));
    K_0_ = pool_->structure.zero();

    const std::vector<skeleton::BlockStructure::Block> curvature = effects.curvature(effects.rest());
    for (std::size_t p = 0; p < curvature.size(); ++p) {
        add(effects.pairs()[p][0], effects.pairs()[p][1], curvature[p], K_0_);
    }
}

/// Adds a block at spheres (a, b), and its transpose at (b, a), where both are free.
void LinearStatics::add(int a, int b, const skeleton::BlockStructure::Block& block, fem::LowerMatrix& K) const {
    if (number_[a] >= 0 && number_[b] >= 0) pool_->structure.add(number_[a], number_[b], block, K);
}

fem::LowerMatrix LinearStatics::matrix(const Eigen::VectorXd& k) const {
    const LinksAtRest& links = *links_;
    fem::LowerMatrix K = K_0_;
    for (Eigen::Index l = 0; l < std::ssize(links.ends); ++l) {
        const Eigen::Index from = links.first[l], count = links.first[l + 1] - from;
        const skeleton::Stiffnesses own = links.order.link(k, l);
        Eigen::VectorXd weights = links.weights.segment(from, count);
        for (Eigen::Index j = 0; j < count; ++j) weights[j] *= own[links.kind[from + j]];
        const auto f = links.strains.middleCols(from, count);
        const skeleton::Mat12 H = (f * weights.asDiagonal()).lazyProduct(f.transpose());
        const auto& [a, b] = links.ends[l];
        add(a, a, H.topLeftCorner<6, 6>(), K);
        add(b, b, H.bottomRightCorner<6, 6>(), K);
        add(a, b, H.topRightCorner<6, 6>(), K);
    }
    const skeleton::PlacedVolumes& volumes = links.placed.volumes();
    if (volumes.empty()) return K;
    const std::vector<skeleton::BlockStructure::Block> blocks = volumes.linear_curvature(k);
    for (std::size_t p = 0; p < blocks.size(); ++p) {
        add(volumes.pairs()[p][0], volumes.pairs()[p][1], blocks[p], K);
    }
    return K;
}

std::shared_ptr<const LinearStatics::Factor> LinearStatics::factor(const Eigen::VectorXd& k) const {
    auto result = std::make_shared<Factor>(pool_);
    if (!result->factor_->factor(matrix(k))) {
        skeleton::StaticsSolver(model_).linear_steps(k, Eigen::MatrixXd::Zero(model_.dofs(), 1));  // says where
        throw SolverFailure("the model is singular to rounding: its stiffnesses lie too far apart");
    }
    return result;
}

LinearStatics::Factor::Factor(std::shared_ptr<FactorPool> pool) : pool_(std::move(pool)) {
    {
        const std::scoped_lock lock(pool_->mutex);
        if (!pool_->idle.empty()) {
            factor_ = std::move(pool_->idle.back());
            pool_->idle.pop_back();
            return;
        }
    }
    factor_ = std::make_unique<fem::Cholesky>(pool_->structure.supernodes());
}

LinearStatics::Factor::~Factor() {
    const std::scoped_lock lock(pool_->mutex);
    pool_->idle.push_back(std::move(factor_));
}

fem::MultiVector LinearStatics::Factor::solve(const fem::MultiVector& F) const {
    const std::vector<int>& free = pool_->free;
    const auto from = [&](std::size_t i) { return Eigen::Index{6} * pool_->structure.position(static_cast<int>(i)); };
    fem::MultiVector packed(6 * std::ssize(free), F.cols());
    for (std::size_t i = 0; i < free.size(); ++i) {
        packed.middleRows<6>(from(i)) = F.middleRows<6>(Eigen::Index{6} * free[i]);
    }
    factor_->solve(packed);
    fem::MultiVector X = fem::MultiVector::Zero(F.rows(), F.cols());
    for (std::size_t i = 0; i < free.size(); ++i) {
        X.middleRows<6>(Eigen::Index{6} * free[i]) = packed.middleRows<6>(from(i));
    }
    return X;
}

}  // namespace palpate::identify
