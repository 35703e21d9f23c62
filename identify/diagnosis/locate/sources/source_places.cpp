#include "identify/diagnosis/locate/sources/source_places.h"

#include <array>
#include <cmath>
#include <utility>

#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// Radii in shares of the body's size, each half of the next, and how many places cover a body with each.
/// Design choice: more places cost memory and time, fewer tell less well where a source is.
constexpr std::array<std::pair<double, int>, 3> radii{{{0.08, 40}, {0.16, 16}, {0.32, 6}}};

}  // namespace

SourcePlaces::SourcePlaces(const Points& points, const Eigen::VectorXd& shares, double size) {
    std::vector<Eigen::VectorXd> columns;
    const auto add = [&](const Vec3& seed, double radius, std::size_t alike) {
        const Eigen::VectorXd weight = source_weight(seed, radius, points);
        const WeightPlace shared = place_of(shares.cwiseProduct(weight), points);
        if (!(shared.norm > 0)) return;
        SourcePlace place{.centre = std::isinf(radius) ? shared.centroid : seed,
                          .radius = radius,
                          .extent = shared.extent,
                          .norm = shared.norm};
        place.log_prior = -std::log(static_cast<double>((std::size(radii) + 1) * alike));
        places.push_back(place);
        columns.push_back(weight);
    };
    for (const auto& [share, count] : radii) {
        const std::vector<int> seeds = mesh::farthest_points(points, count);
        for (const int seed : seeds) add(points.row(seed), share * size, seeds.size());
    }
    add(Vec3::Zero(), INFINITY, 1);
    weights.resize(points.rows(), std::ssize(columns));
    for (std::size_t c = 0; c < columns.size(); ++c) weights.col(static_cast<Eigen::Index>(c)) = columns[c];
}

Eigen::MatrixXd SourcePlaces::unit(const Eigen::VectorXd& shares) const {
    Eigen::MatrixXd result = shares.asDiagonal() * weights;
    for (Eigen::Index c = 0; c < count(); ++c) result.col(c) /= places[static_cast<std::size_t>(c)].norm;
    return result;
}

Eigen::MatrixXd spread(const Eigen::MatrixXd& of_points, const Eigen::MatrixXd& weights) {
    Eigen::MatrixXd result(of_points.cols(), 3 * weights.cols());
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::MatrixXd component = of_points(Eigen::seq(axis, Eigen::last, 3), Eigen::all);
        const Eigen::MatrixXd along = component.transpose() * weights;
        for (Eigen::Index c = 0; c < weights.cols(); ++c) result.col(3 * c + axis) = along.col(c);
    }
    return result;
}

Eigen::MatrixXd directed(const Eigen::MatrixXd& of_points, const Points& forces, const Eigen::MatrixXd& weights) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(of_points.cols(), weights.cols());
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::MatrixXd component = of_points(Eigen::seq(axis, Eigen::last, 3), Eigen::all);
        result += component.transpose() * (forces.col(axis).asDiagonal() * weights);
    }
    return result;
}

}  // namespace palpate::identify
