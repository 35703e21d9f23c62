#include "mesh/geometry/sampling.h"

#include <algorithm>

namespace palpate::mesh {

std::vector<int> farthest_points(const Points& points, int count, int first) {
    const auto wanted = std::min<Eigen::Index>(count, points.rows());
    std::vector<int> chosen;
    if (wanted <= 0) return chosen;
    chosen.push_back(first);
    Eigen::VectorXd distance = (points.rowwise() - points.row(first)).rowwise().squaredNorm();
    while (static_cast<Eigen::Index>(chosen.size()) < wanted) {
        Eigen::Index next = 0;
        distance.maxCoeff(&next);
        chosen.push_back(static_cast<int>(next));
        distance = distance.cwiseMin((points.rowwise() - points.row(next)).rowwise().squaredNorm());
    }
    return chosen;
}

Eigen::Index nearest_seed(const Points& points, const std::vector<int>& seeds, Eigen::Index point) {
    Eigen::Index nearest = 0;
    (points(seeds, Eigen::all).rowwise() - points.row(point)).rowwise().squaredNorm().minCoeff(&nearest);
    return nearest;
}

}  // namespace palpate::mesh
