#include "skeleton/links/placed/placed_volumes.h"

#include <algorithm>
#include <map>

#include "skeleton/links/full_link.h"
#include "skeleton/links/placed/grown_links.h"
#include "skeleton/model/stiffness_order.h"

namespace palpate::skeleton {

namespace {

constexpr int elongation = static_cast<int>(Stiffness::elongation);

}  // namespace

PlacedVolumes::PlacedVolumes(const Model& model, const fem::Effects& effects)
    : links_(grown_links(model, effects.growth)),
      rest_(rest_state(model)),
      linear_poses_(straight_poses(model, links_)),
      pair_of_link_(3 * model.links.size(), -1) {
    const StiffnessOrder order(model);
    if (!order.full()) return;
    std::vector<std::vector<int>> links_of(model.spheres.size());
    for (int l = 0; l < static_cast<int>(links_.size()); ++l) {
        links_of[links_[l].a].push_back(l);
        links_of[links_[l].b].push_back(l);
    }
    std::map<std::array<int, 2>, int> place;
    const auto pair = [&](int a, int b) {
        const auto [at, fresh] = place.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(pairs_.size()));
        if (fresh) pairs_.push_back(at->first);
        return at->second;
    };
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        const Sphere& sphere = model.spheres[i];
        if (!(sphere.cell > 0) || !(sphere.volume > 0) || links_of[i].empty()) continue;
        double scale = 1;
        for (const auto& effect : effects.material) scale *= effect->stiffness(sphere.center);
        cells_.push_back({i, order.of_sphere(i), sphere.cell, scale, links_of[i]});
        std::vector<int> members{i};
        for (const int l : links_of[i]) {
            members.push_back(links_[l].a == i ? links_[l].b : links_[l].a);
            pair_of_link_[3 * l] = pair(links_[l].a, links_[l].b);
            pair_of_link_[3 * l + 1] = pair(links_[l].a, links_[l].a);
            pair_of_link_[3 * l + 2] = pair(links_[l].b, links_[l].b);
        }
        std::ranges::sort(members);
        std::vector<int> pairs;
        for (std::size_t p = 0; p < members.size(); ++p) {
            for (std::size_t q = p; q < members.size(); ++q) pairs.push_back(pair(members[p], members[q]));
        }
        pair_of_.push_back(std::move(pairs));
    }
}

std::vector<LinkPose> PlacedVolumes::poses(const State& state) const {
    std::vector<LinkPose> result;
    result.reserve(links_.size());
    for (const Link& link : links_) result.push_back(pose(link, state));
    return result;
}

std::vector<PlacedVolumes::Swelling> PlacedVolumes::swellings(const std::vector<LinkPose>& poses) const {
    std::vector<Swelling> result(links_.size());
    for (std::size_t l = 0; l < links_.size(); ++l) {
        if (pair_of_link_[3 * l] < 0) continue;
        const FullLink link = full_link(links_[l], rest_, poses[l]);
        const double half = 0.5 * links_[l].section->area;
        result[l] = {half * link.strains()[elongation], half * link.gradients().col(elongation)};
    }
    return result;
}

PlacedVolumes::Gradient PlacedVolumes::gradient_of(const Cell& cell, const std::vector<Swelling>& swellings,
                                                   double& change) const {
    change = 0;
    std::map<int, Eigen::Matrix<double, 6, 1>> sum;
    sum.try_emplace(cell.sphere, Eigen::Matrix<double, 6, 1>::Zero());
    for (const int l : cell.links) {
        change += swellings[l].volume;
        sum.try_emplace(links_[l].a, Eigen::Matrix<double, 6, 1>::Zero()).first->second +=
            swellings[l].gradient.head<6>();
        sum.try_emplace(links_[l].b, Eigen::Matrix<double, 6, 1>::Zero()).first->second +=
            swellings[l].gradient.tail<6>();
    }
    return {sum.begin(), sum.end()};
}

double PlacedVolumes::energy(const Eigen::VectorXd& k, const State& state) const {
    const std::vector<Swelling> all = swellings(poses(state));
    double sum = 0;
    for (const Cell& cell : cells_) {
        double change = 0;
        for (const int l : cell.links) change += all[l].volume;
        sum += 0.5 * cell.scale * k[cell.place] * change * change / cell.volume;
    }
    return sum;
}

Eigen::VectorXd PlacedVolumes::force(const Eigen::VectorXd& k, const State& state) const {
    const std::vector<Swelling> all = swellings(poses(state));
    Eigen::VectorXd f = Eigen::VectorXd::Zero(6 * rest_.x.rows());
    for (const Cell& cell : cells_) {
        double change = 0;
        const Gradient gradient = gradient_of(cell, all, change);
        const double pressure = cell.scale * k[cell.place] * change / cell.volume;
        for (const auto& [sphere, own] : gradient) f.segment<6>(Eigen::Index{6} * sphere) -= pressure * own;
    }
    return f;
}

std::vector<PlacedVolumes::Block> PlacedVolumes::curvature(const Eigen::VectorXd& k,
                                                           const std::vector<LinkPose>& poses) const {
    const std::vector<Swelling> all = swellings(poses);
    std::vector<Block> blocks(pairs_.size(), Block::Zero());
    std::vector<double> pressures(links_.size(), 0);  // on each link's section, of the cells at both ends
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        const Cell& cell = cells_[c];
        double change = 0;
        const Gradient gradient = gradient_of(cell, all, change);
        const double stiffness = cell.scale * k[cell.place] / cell.volume;
        auto pair = pair_of_[c].begin();
        for (std::size_t p = 0; p < gradient.size(); ++p) {
            for (std::size_t q = p; q < gradient.size(); ++q) {
                blocks[*pair++] += stiffness * gradient[p].second * gradient[q].second.transpose();
            }
        }
        for (const int l : cell.links) pressures[l] += stiffness * change;
    }
    for (std::size_t l = 0; l < links_.size(); ++l) {
        if (pair_of_link_[3 * l] < 0 || pressures[l] == 0) continue;
        FullLink::Strains factors = FullLink::Strains::Zero();
        factors[elongation] = 0.5 * links_[l].section->area * pressures[l];
        Mat12 H = Mat12::Zero();
        full_link(links_[l], rest_, poses[l]).add_curvature(factors, H);
        blocks[pair_of_link_[3 * l]] += H.topRightCorner<6, 6>();
        blocks[pair_of_link_[3 * l + 1]] += H.topLeftCorner<6, 6>();
        blocks[pair_of_link_[3 * l + 2]] += H.bottomRightCorner<6, 6>();
    }
    return blocks;
}

void PlacedVolumes::add_forces(const State& state, std::vector<Eigen::Triplet<double>>& entries) const {
    const std::vector<Swelling> all = swellings(poses(state));
    for (const Cell& cell : cells_) {
        double change = 0;
        for (const auto& [sphere, own] : gradient_of(cell, all, change)) {
            for (int i = 0; i < 6; ++i) {
                entries.emplace_back(6 * sphere + i, static_cast<int>(cell.place),
                                     -cell.scale * change / cell.volume * own[i]);
            }
        }
    }
}

void PlacedVolumes::add_linear_forces(const Eigen::VectorXd& step, std::vector<Eigen::Triplet<double>>& entries) const {
    // At rest nothing has swollen but by links that rest at another length than their spheres' distance.
    const std::vector<Swelling> all = swellings(linear_poses_), at_rest = swellings(poses(rest_));
    for (const Cell& cell : cells_) {
        double change = 0;
        const Gradient gradient = gradient_of(cell, all, change);
        Eigen::VectorXd force = Eigen::VectorXd::Zero(step.size());
        double swollen = 0;
        for (const int l : cell.links) swollen += at_rest[l].volume;
        for (const auto& [sphere, own] : gradient) swollen += own.dot(step.segment<6>(Eigen::Index{6} * sphere));
        for (const auto& [sphere, own] : gradient) force.segment<6>(Eigen::Index{6} * sphere) -= swollen * own;
        for (const int l : cell.links) {
            if (change == 0) break;
            FullLink::Strains factors = FullLink::Strains::Zero();
            factors[elongation] = 0.5 * links_[l].section->area * change;
            Mat12 H = Mat12::Zero();
            full_link(links_[l], rest_, linear_poses_[l]).add_curvature(factors, H);
            Vec12 own;
            own << step.segment<6>(Eigen::Index{6} * links_[l].a), step.segment<6>(Eigen::Index{6} * links_[l].b);
            const Vec12 more = H * own;
            force.segment<6>(Eigen::Index{6} * links_[l].a) -= more.head<6>();
            force.segment<6>(Eigen::Index{6} * links_[l].b) -= more.tail<6>();
        }
        for (const auto& [sphere, own] : gradient) {
            for (int i = 0; i < 6; ++i) {
                entries.emplace_back(6 * sphere + i, static_cast<int>(cell.place),
                                     cell.scale / cell.volume * force[6 * sphere + i]);
            }
        }
    }
}

}  // namespace palpate::skeleton
