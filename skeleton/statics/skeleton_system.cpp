#include "skeleton/statics/skeleton_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "mesh/errors.h"
#include "skeleton/model/growth.h"
#include "skeleton/statics/statics.h"

namespace palpate::skeleton {

namespace {

// Links reach from a held sphere to every other one, or there is no equilibrium.
void require_held(const Model& model) {
    const int n = static_cast<int>(model.spheres.size());
    std::vector<std::vector<int>> neighbours(n);
    for (const Link& link : model.links) {
        neighbours[link.a].push_back(link.b);
        neighbours[link.b].push_back(link.a);
    }
    std::vector<char> seen(n, 0);
    std::vector<int> reached;
    const auto reach = [&](int i) {
        if (!seen[i]) reached.push_back(i);
        seen[i] = 1;
    };
    for (int i = 0; i < n; ++i)
        if (model.spheres[i].held) reach(i);
    if (reached.empty())
        throw InvalidInput(
            fmt::format("none of the model's {} spheres is held, so nothing stops it from moving away: "
                        "let a support hold one, or set its 'held' to true",
                        n));
    size_t next = 0;
    while (next < reached.size())
        for (const int j : neighbours[reached[next++]]) reach(j);

    const auto loose = std::find(seen.begin(), seen.end(), 0) - seen.begin();
    if (loose == n) return;
    const Vec3& c = model.spheres[loose].center;
    throw InvalidInput(
        fmt::format("sphere {} at ({:.6g}, {:.6g}, {:.6g}) hangs on no held sphere, and {} of {} do not: "
                    "link it to the others or hold it",
                    loose, c.x(), c.y(), c.z(), n - static_cast<int>(reached.size()), n));
}

// Where an effect takes the place of the supports it moves what they held; but a held sphere that nothing is joined to
// stays, as nothing determines where it would go.
void release(const PlacedEffects& effects, Model& body) {
    if (!effects.release_supports()) return;
    std::vector<char> moves = effects.supported();
    for (const Link& link : body.links) moves[link.a] = moves[link.b] = 1;
    for (size_t i = 0; i < body.spheres.size(); ++i)
        if (moves[i]) body.spheres[i].held = false;
}

}  // namespace

SkeletonSystem::SkeletonSystem(const Model& model, const fem::Effects& effects)
    : effects_(model, effects), links_(model, effects) {
    require_held(model);
    body_.law = model.law;
    body_.spheres = model.spheres;
    body_.links = model.links;
    release(effects_, body_);
    start_ = grown_start(body_, effects.growth);
    if (!effects.growth.parts.empty()) growing_ = effects;

    for (const Sphere& sphere : body_.spheres) {
        reach_ = std::max(reach_, sphere.center.cwiseAbs().maxCoeff());
        block_of_.push_back(sphere.held ? -1 : static_cast<int>(free_.size()));
        if (!sphere.held) free_.push_back(static_cast<int>(block_of_.size()) - 1);
    }
    double sum = 0;
    for (const Link& link : body_.links) {
        sum += link.length;
        coupling_of_.push_back(coupling(link.a, link.b));
    }
    for (const auto& [a, b] : effects_.pairs()) coupling_of_pair_.push_back(coupling(a, b));
    for (const auto& [a, b] : links_.volumes().pairs()) coupling_of_cell_.push_back(coupling(a, b));
    if (!body_.links.empty()) length_ = sum / static_cast<double>(body_.links.size());
    metric_ << 1, 1, 1, length_ * length_, length_ * length_, length_ * length_;

    std::vector<char> moves;
    for (const Sphere& sphere : body_.spheres) moves.push_back(sphere.held ? 0 : 1);
    branches_ = Branches(body_.links, moves);

    effect_load_ = std::max(largest_force(effects_.load_at_rest()), effects_.load_of_tools(length_));
    for (const BlockCholesky::Block& block : effects_.curvature(effects_.rest()))
        effect_stiffness_ = std::max(effect_stiffness_, block.diagonal().cwiseAbs().cwiseQuotient(metric_).maxCoeff());
}

void SkeletonSystem::scale_effects(double share) {
    if (growing_ && share != effect_share_) {
        fem::Effects effects = *growing_;
        for (fem::Growth::Part& part : effects.growth.parts) part.growth *= share;
        links_ = PlacedLinks(body_, effects);
    }
    effect_share_ = share;
}

// The place of the coupling of two spheres, a new one if need be; -1: one sphere alone, or one is held.
int SkeletonSystem::coupling(int a, int b) {
    if (a == b || block_of_[a] < 0 || block_of_[b] < 0) return -1;
    const auto [at, fresh] = place_of_coupling_.try_emplace({a, b}, static_cast<int>(couplings_.size()));
    if (fresh) couplings_.push_back({block_of_[a], block_of_[b]});
    return at->second;
}

void SkeletonSystem::prepare(const Load& load) {
    const std::size_t before = couplings_.size();
    for (const PointForce& force : load.forces)
        for (const SphereInfluence& s : force.at.shares)
            for (const SphereInfluence& t : force.at.shares)
                if (s.sphere < t.sphere) coupling(s.sphere, t.sphere);
    if (load.cavities)
        for (const auto& [a, b] : load.cavities->joined()) coupling(a, b);
    if (couplings_.size() > before) matrix_.reset();
}

void SkeletonSystem::remember(const FibreStates& before) {
    assert(before.empty() || before.size() == fibres_per_link * body_.links.size());
    before_ = before;
}

Balance SkeletonSystem::balance(const Eigen::VectorXd& k, const State& state, const Load& load) const {
    assert(k.size() == links_.order().size());
    double elastic = 0, size = 0;
    Eigen::VectorXd net = external_force(body_, state, load);
    for (size_t l = 0; l < body_.links.size(); ++l) {
        const Link& link = body_.links[l];
        const LinkTerms terms = links_.terms(l, state, false, before_);
        const Stiffnesses own = links_.order().link(k, static_cast<Eigen::Index>(l));
        const double energy = terms.energy.dot(own);
        elastic += energy;
        size += std::abs(energy);
        const Vec12 gradient = terms.gradient * own;
        net.segment<6>(Eigen::Index{6} * link.a) -= gradient.head<6>();
        net.segment<6>(Eigen::Index{6} * link.b) -= gradient.tail<6>();
    }
    if (!links_.volumes().empty()) {
        const double energy = links_.volumes().energy(k, state);
        elastic += energy;
        size += energy;
        net += links_.volumes().force(k, state);
    }
    if (!effects_.empty()) net += effects_.force(state, effect_share_);
    for (size_t i = 0; i < body_.spheres.size(); ++i)
        if (body_.spheres[i].held) net.segment<6>(6 * i).setZero();

    const double work = external_work(body_, state, load);
    const PlacedEffects::Energy effects = effects_.energy(state, effect_share_);
    return {elastic - work + effects.sum, 1e-14 * (size + std::abs(work) + effects.size), net, largest_force(net)};
}

double SkeletonSystem::largest_load(const Eigen::VectorXd& k, const State& state, const Load& load) const {
    return std::max(
        {largest_force(external_force(body_, state, load)), effect_load_, links_.largest_rest_force(k, before_)});
}

double SkeletonSystem::largest_force(const Eigen::VectorXd& f) const {
    double most = 0;
    for (const Eigen::Index i : free_)
        most = std::max({most, f.segment<3>(6 * i).norm(), f.segment<3>(6 * i + 3).norm() / length_});
    return most;
}

double SkeletonSystem::stiffest(const Eigen::VectorXd& k) const {
    double most = effect_stiffness_;
    for (size_t l = 0; l < body_.links.size(); ++l) {
        const Stiffnesses own = links_.rest_stiffness(l, links_.order().link(k, static_cast<Eigen::Index>(l)));
        for (Eigen::Index s = 0; s < own.size(); ++s) {
            const bool turns = s >= 1 && s <= 3;
            most = std::max(most, turns ? own[s] / (length_ * length_) : own[s]);
        }
    }
    return most;
}

double SkeletonSystem::force_rounding(const Eigen::VectorXd& k) const {
    // Positions are known to 1e-16 of the largest coordinate, angles to 1e-16; some tens of them add up.
    return 1e-14 * stiffest(k) * (reach_ + 10 * length_);
}

double SkeletonSystem::step_limit(const State& state, const Eigen::VectorXd& step) const {
    double times_too_long = 1;
    for (const Eigen::Index i : free_)
        times_too_long = std::max(times_too_long, step.segment<3>(6 * i + 3).norm() / 0.5);
    for (const Link& link : body_.links) {
        const auto own = step.segment<6>(Eigen::Index{6} * link.b), near = step.segment<6>(Eigen::Index{6} * link.a);
        Vec3 apart = own.head<3>() - near.head<3>();
        if (!branches_.empty()) {
            const Vec3 arm = state.x.row(link.b) - state.x.row(link.a);
            apart = Branches::stretch(arm, apart, (own.tail<3>() + near.tail<3>()) / 2);
        }
        times_too_long = std::max(times_too_long, apart.norm() / (0.5 * link.length));
    }
    return 1 / times_too_long;
}

State SkeletonSystem::advance(const State& state, const Eigen::VectorXd& step, double share) const {
    State next = skeleton::advance(state, share * step);
    for (const auto& [sphere, near] : branches_.tree_edges()) {
        const auto own = step.segment<6>(Eigen::Index{6} * sphere), inner = step.segment<6>(Eigen::Index{6} * near);
        const Vec3 arm = state.x.row(sphere) - state.x.row(near);
        next.x.row(sphere) = next.x.row(near) + Branches::carried(arm, own.head<3>() - inner.head<3>(),
                                                                  (own.tail<3>() + inner.tail<3>()) / 2, share)
                                                    .transpose();
    }
    return next;
}

void SkeletonSystem::assemble(const Eigen::VectorXd& k, const State& state, const Load* load, bool unstrained) {
    assert(k.size() == links_.order().size());
    if (load) prepare(*load);
    if (!matrix_) matrix_ = make_tangent_matrix(static_cast<int>(free_.size()), couplings_);
    matrix_->set_zero();
    for (size_t l = 0; l < body_.links.size(); ++l) {
        const Link& link = body_.links[l];
        const Stiffnesses own = links_.order().link(k, static_cast<Eigen::Index>(l));
        const Mat12 H =
            unstrained ? links_.linear_hessian(l, own, before_) : links_.hessian(l, own, pose(link, state), before_);
        const int i = block_of_[link.a], j = block_of_[link.b];
        if (i >= 0) matrix_->add_diagonal(i, H.topLeftCorner<6, 6>());
        if (j >= 0) matrix_->add_diagonal(j, H.bottomRightCorner<6, 6>());
        if (coupling_of_[l] >= 0) matrix_->add_coupling(coupling_of_[l], H.topRightCorner<6, 6>());
    }
    if (!links_.volumes().empty())
        add_pairs(links_.volumes().pairs(), coupling_of_cell_,
                  unstrained ? links_.volumes().linear_curvature(k) : links_.volumes().curvature(k, state));
    add_pairs(effects_.pairs(), coupling_of_pair_, effects_.curvature(state, effect_share_));
    if (!load) return;
    for (const auto& [a, b, block] : external_curvature(body_, state, *load)) {
        if (a == b && block_of_[a] >= 0) matrix_->add_diagonal(block_of_[a], -block);
        if (const int c = coupling(a, b); c >= 0) matrix_->add_coupling(c, -block);
    }
}

void SkeletonSystem::add_pairs(const std::vector<std::array<int, 2>>& pairs, const std::vector<int>& couplings,
                               const std::vector<BlockCholesky::Block>& blocks) {
    for (size_t p = 0; p < blocks.size(); ++p) {
        const auto [a, b] = pairs[p];
        if (a == b && block_of_[a] >= 0) matrix_->add_diagonal(block_of_[a], blocks[p]);
        if (couplings[p] >= 0) matrix_->add_coupling(couplings[p], blocks[p]);
    }
}

std::optional<BlockCholesky::BadPivot> SkeletonSystem::factor(double shift) { return matrix_->factor(shift, metric_); }

void SkeletonSystem::factor_stable(const Eigen::VectorXd& k) {
    if (const auto pivot = factor(0)) fail_at(*pivot, k);
}

void SkeletonSystem::fail_at(const BlockCholesky::BadPivot& pivot, const Eigen::VectorXd& k) const {
    const int sphere = free_[pivot.block];
    const std::string motion =
        fmt::format("{} {}", pivot.entry < 3 ? "move along" : "turn about", std::array{"x", "y", "z"}[pivot.entry % 3]);
    if (!pivot.zero)
        throw SolverFailure(
            fmt::format("the model is not stable: sphere {} would {} by itself. Links that rest at "
                        "another length than their spheres' distance, or loads beyond buckling, do that",
                        sphere, motion));
    std::string slack;
    for (size_t l = 0; l < body_.links.size(); ++l)
        for (int s = 0; s < links_.order().per_link(); ++s) {
            const Link& link = body_.links[l];
            if ((link.a == sphere || link.b == sphere) &&
                k[links_.order().of_link(static_cast<Eigen::Index>(l), s)] == 0)
                slack += fmt::format("{}{} of links[{}] (spheres {} and {})", slack.empty() ? "" : ", ",
                                     stiffness_names[s], l, link.a, link.b);
        }
    throw SolverFailure(fmt::format("sphere {} is free to {}: {}", sphere, motion,
                                    slack.empty() ? "its links are too slack; raise their stiffness"
                                                  : "zero are " + slack + "; raise one of them"));
}

Eigen::MatrixXd SkeletonSystem::solve(const Eigen::MatrixXd& B) const {
    assert(B.rows() == body_.dofs());
    Eigen::MatrixXd packed(6 * free_.size(), B.cols());
    for (size_t i = 0; i < free_.size(); ++i) packed.middleRows<6>(6 * i) = B.middleRows<6>(Eigen::Index{6} * free_[i]);
    matrix_->solve(packed);
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(B.rows(), B.cols());
    for (size_t i = 0; i < free_.size(); ++i) X.middleRows<6>(Eigen::Index{6} * free_[i]) = packed.middleRows<6>(6 * i);
    return X;
}

Eigen::VectorXd SkeletonSystem::metric_times(const Eigen::VectorXd& step) const {
    return step.cwiseProduct(metric_.replicate(static_cast<Eigen::Index>(body_.spheres.size()), 1));
}

}  // namespace palpate::skeleton
