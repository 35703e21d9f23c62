#include "mesh/supports/support_points.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/geometry/surface_tree.h"

namespace palpate::mesh {
namespace {

constexpr double covers = 0.75;       // times their distance: points of a square grid leave 0.71 of it uncovered
constexpr double gap_factor = 2.5;    // times their distance: all round a point in a gap
constexpr double whole_patch = 0.45;  // of a disc round a point: at the edge of a wide patch there is half of it

/// How far points are from their nearest neighbours: 9 of 10 nearer than this [mm].
double spacing_of(const Points& points) {
    constexpr Eigen::Index asked = 500;  // points that are asked: a sample tells
    if (points.rows() < 2) return 0;
    std::vector<double> nearest;
    const Eigen::Index step = std::max<Eigen::Index>(1, points.rows() / asked);
    for (Eigen::Index i = 0; i < points.rows(); i += step) {
        Eigen::VectorXd squares = (points.rowwise() - points.row(i)).rowwise().squaredNorm();
        squares[i] = squares.maxCoeff() + 1;
        nearest.push_back(std::sqrt(squares.minCoeff()));
    }
    const auto rank = nearest.begin() + std::ssize(nearest) * 9 / 10;
    std::ranges::nth_element(nearest, rank);
    return *rank;
}

struct Piece {
    Vec3 at;
    double area;  // [mm^2]
};

/// Pieces of the surface, about `size` long, that the region holds.
std::vector<Piece> held_pieces(const PointsRegion& region, const Surface& surface, double size) {
    constexpr int most_cuts = 200;
    const Box box = bounding_box(region.points);
    const double margin = region.within;
    std::vector<Piece> held;
    for (const auto& t : surface.triangles.rowwise()) {
        const Vec3 a = surface.vertices.row(t[0]), b = surface.vertices.row(t[1]), c = surface.vertices.row(t[2]);
        const Vec3 low = a.cwiseMin(b).cwiseMin(c).array() - margin, high = a.cwiseMax(b).cwiseMax(c).array() + margin;
        if ((low.array() > box.max.array()).any() || (high.array() < box.min.array()).any()) continue;
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        const int n = std::clamp(static_cast<int>(std::ceil(longest / size)), 1, most_cuts);
        const double area = (b - a).cross(c - a).norm() / (2.0 * n * n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n - i; ++j)
                for (const double shift : {1.0 / 3, 2.0 / 3}) {  // upright, and upside down
                    if (shift > 0.5 && j >= n - i - 1) continue;
                    const Vec3 at = a + (i + shift) / n * (b - a) + (j + shift) / n * (c - a);
                    if (contains(region, at)) held.push_back({at, area});
                }
    }
    return held;
}

/// Points near which the region holds less of the surface than an element's patch, whichever of them is asked within
/// an element's length.
std::vector<Eigen::Index> narrow_points(const PointsRegion& region, const std::vector<Piece>& held, double edge) {
    const double radius = edge / 2, disc = std::numbers::pi * radius * radius;
    Eigen::VectorXd area = Eigen::VectorXd::Zero(region.points.rows());
    for (const Piece& piece : held) {
        const Eigen::VectorXd squares = (region.points.rowwise() - piece.at.transpose()).rowwise().squaredNorm();
        area.array() += (squares.array() <= radius * radius).select(piece.area, Eigen::ArrayXd::Zero(area.size()));
    }
    const Points& points = region.points;
    std::vector<Eigen::Index> wide, narrow;
    for (Eigen::Index i = 0; i < points.rows(); ++i)
        if (area[i] >= whole_patch * disc) wide.push_back(i);
    const Points on_wide = points(wide, Eigen::all);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const bool is_near =
            !wide.empty() && (on_wide.rowwise() - points.row(i)).rowwise().squaredNorm().minCoeff() <= edge * edge;
        if (!is_near) narrow.push_back(i);
    }
    return narrow;
}

}  // namespace

PatchedSupports patched(const std::vector<Region>& supports, const Surface& surface, double edge_length,
                        const std::string& name) {
    PatchedSupports result{supports, {}, {}};
    const bool any = std::ranges::any_of(supports, [](const Region& r) {
        const auto* cloud = std::get_if<PointsRegion>(&r);
        return cloud && cloud->joined < 0 && cloud->points.rows() > 0;
    });
    if (!any || surface.triangles.rows() == 0) return result;
    const SurfaceTree tree(surface);
    const auto off_the_body = [&](const Vec3& p, double within) {
        return tree.closest(p).distance > within && !tree.inside(p);
    };
    for (std::size_t s = 0; s < supports.size(); ++s) {
        auto* cloud = std::get_if<PointsRegion>(&result.regions[s]);
        if (!cloud || cloud->joined >= 0 || cloud->points.rows() == 0) continue;
        const double spacing = spacing_of(cloud->points);
        if (cloud->within < covers * spacing && spacing <= edge_length) {
            cloud->joined = std::min(gap_factor * spacing, edge_length);
            result.notes.push_back(fmt::format(
                "{} {}: its {} points are {:.3g} mm apart, further than 'within' ({:.3g} mm) covers, and are "
                "joined: what lies between points nearer than {:.3g} mm to each other is held too ('joined: 0' says "
                "otherwise).",
                name, s + 1, cloud->points.rows(), spacing, cloud->within, cloud->joined));
        }
        const PointsRegion given = *cloud;
        std::vector<Eigen::Index> off;
        for (Eigen::Index i = 0; i < given.points.rows(); ++i)
            if (off_the_body(given.points.row(i), given.within)) off.push_back(i);
        if (!off.empty())
            result.warnings.push_back(fmt::format(
                "{} {}: {} of its {} points lie further than 'within' ({:.3g} mm) off the body and hold nothing "
                "by themselves, the first at ({:.4g}, {:.4g}, {:.4g}) mm. Are their unit and frame those of the rest "
                "surface?",
                name, s + 1, off.size(), given.points.rows(), given.within, given.points(off[0], 0),
                given.points(off[0], 1), given.points(off[0], 2)));
        const std::vector<Eigen::Index> narrow =
            narrow_points(given, held_pieces(given, surface, edge_length / 8), edge_length);
        if (narrow.empty() || given.within >= edge_length / 2) continue;
        result.notes.push_back(
            fmt::format("{} {}: round {} of its {} points it is narrower than an element is long ({:.3g} mm): "
                        "there all within "
                        "{:.3g} mm of them is held, or no node would be (shorter elements, --edge-length, hold less).",
                        name, s + 1, narrow.size(), given.points.rows(), edge_length, edge_length / 2));
        std::get<PointsRegion>(result.regions[s]).joined = std::max(0.0, given.joined);  // it is seen to
        result.regions.emplace_back(PointsRegion{given.points(narrow, Eigen::all), edge_length / 2, 0});
    }
    return result;
}

}  // namespace palpate::mesh
