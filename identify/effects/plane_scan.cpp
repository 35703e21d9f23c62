#include "identify/effects/plane_scan.h"

#include <algorithm>

#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// The 26 directions to the neighbours in a lattice.
std::vector<Vec3> lattice_directions() {
    std::vector<Vec3> result;
    for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
            for (int k = -1; k <= 1; ++k) {
                if (i != 0 || j != 0 || k != 0) result.push_back(Vec3(i, j, k).normalized());
            }
        }
    }
    return result;
}

/// Points of the skin that a plane may push on: free, and away from the supports.
std::vector<char> free_skin(const BodyModel& model) {
    // A design choice: what touches nearer to a support is hardly told from the support.
    const double away = 0.1 * model.size();
    const double no_area = 1e-6 * model.skin_areas().maxCoeff();  // what rounding makes of the corners of faces
    std::vector<char> result(model.skin().rows());
    for (Eigen::Index i = 0; i < model.skin().rows(); ++i) {
        const double gap = (model.support_points().rowwise() - model.skin().row(i)).rowwise().norm().minCoeff();
        result[i] = gap > away && model.skin_areas()[i] > no_area;
    }
    return result;
}

/// Forces >= 0 that leave no gap below 0: C f >= h, f >= 0, f . (C f - h) = 0, by projected Gauss-Seidel.
Eigen::VectorXd complementary(const Eigen::MatrixXd& C, const Eigen::VectorXd& h) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(h.size());
    if (h.maxCoeff() <= 0) return f;
    // Numerical: a diagonal that is 0 divides nothing; sweeps end at a millionth of the largest force, or at a bound
    // that keeps a slow case from holding up the scan, whose planes are fitted afterwards.
    const double floor = 1e-9 * C.diagonal().sum();
    for (int sweep = 0; sweep < 300; ++sweep) {
        double change = 0;
        for (Eigen::Index i = 0; i < h.size(); ++i) {
            const double next = std::max(0.0, f[i] + (h[i] - C.row(i).dot(f)) / (C(i, i) + floor));
            change = std::max(change, std::abs(next - f[i]));
            f[i] = next;
        }
        if (change <= 1e-6 * f.maxCoeff()) break;
    }
    return f;
}

}  // namespace

PlaneScan::PlaneScan(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                     const ForwardSolution& forward) {
    const Points& rest = model.skin();
    const std::vector<char> is_free = free_skin(model);
    std::vector<Points> stands;
    stands.reserve(forward.q.size());
    for (const Eigen::VectorXd& q : forward.q) stands.push_back(model.skin_positions(q, setting));

    std::vector<Eigen::VectorXd> patches;
    for (const Vec3& n : lattice_directions()) {
        // How far the skin reaches beyond where the body is at rest.
        const double at_rest = (rest * n).minCoeff();
        Eigen::VectorXd lowest = rest * n;
        for (const Points& stand : stands) lowest = lowest.cwiseMin(stand * n);
        std::vector<int> beyond;
        for (Eigen::Index i = 0; i < lowest.size(); ++i) {
            if (is_free[i] && lowest[i] < at_rest) beyond.push_back(static_cast<int>(i));
        }
        if (beyond.empty()) continue;
        const double depth = at_rest - lowest(beyond).minCoeff();
        if (depth < 3 * problem.rms_sigma()) continue;

        // Patches round the points that lie apart, each of those next to it.
        constexpr int most_patches = 12;  // a choice: each costs a solve in every action and direction
        const Points candidates = rest(beyond, Eigen::all);
        const std::vector<int> seeds = mesh::farthest_points(candidates, most_patches);
        Direction direction{n, std::ssize(patches), std::ssize(seeds), {}};
        std::vector<Eigen::VectorXd> own(seeds.size(), Eigen::VectorXd::Zero(3 * rest.rows()));
        for (std::size_t i = 0; i < beyond.size(); ++i) {
            const Eigen::Index nearest = mesh::nearest_seed(candidates, seeds, static_cast<Eigen::Index>(i));
            own[nearest].segment<3>(Eigen::Index{3} * beyond[i]) = model.skin_areas()[beyond[i]] * n;
        }
        for (Eigen::VectorXd& patch : own) {
            double area = 0;
            for (Eigen::Index i = 0; i < rest.rows(); ++i) area += patch.segment<3>(3 * i).dot(n);
            patches.push_back(patch / area);
        }
        for (const double share : {0.0, 0.05, 0.1, 0.2, 0.35, 0.5}) {
            direction.offsets.push_back(at_rest - share * depth);
            planes_.push_back({n, direction.offsets.back(), static_cast<int>(directions_.size())});
        }
        directions_.push_back(std::move(direction));
    }
    pressures_.resize(3 * rest.rows(), std::ssize(patches));
    for (std::size_t p = 0; p < patches.size(); ++p) pressures_.col(static_cast<Eigen::Index>(p)) = patches[p];
    for (const Points& stand : stands) {
        height_.emplace_back(pressures_.transpose() * Eigen::Map<const Eigen::VectorXd>(stand.data(), stand.size()));
    }
}

Eigen::MatrixXd PlaneScan::pushed_back(int k, const Eigen::MatrixXd& forces, const Eigen::MatrixXd& steps) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(steps.rows(), width());
    Eigen::Index plane = 0;
    for (const Direction& direction : directions_) {
        const auto own = steps.middleCols(direction.first, direction.count);
        const Eigen::MatrixXd C = forces.middleCols(direction.first, direction.count).transpose() * own;
        const Eigen::VectorXd height = height_[k].segment(direction.first, direction.count);
        for (const double offset : direction.offsets) {
            result.col(plane++) = own * complementary(C, (offset - height.array()).matrix());
        }
    }
    return result;
}

}  // namespace palpate::identify
