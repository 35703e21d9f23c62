#include "skeleton/construction/placement/cover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::skeleton {
namespace {

constexpr double overlap = 0.7;   // largest radius of a sphere in a plate or lump / spacing
constexpr double swelling = 0.5;  // of the distance that points may lie outside

// Few of the allowed balls that hold the points.
std::vector<int> cover(const MedialAxis& axis, const std::vector<char>& allowed, const Points& points,
                       const std::vector<int>& wanted, double delta) {
    const auto n = static_cast<int>(axis.radii.size());
    std::vector<std::vector<int>> held_by(n), holders(wanted.size());
    for (int b = 0; b < n; ++b) {
        if (!allowed[b]) continue;
        for (std::size_t p = 0; p < wanted.size(); ++p) {
            if ((points.row(wanted[p]) - axis.centers.row(b)).norm() > axis.radii(b) + delta) continue;
            held_by[b].push_back(static_cast<int>(p));
            holders[p].push_back(b);
        }
    }
    std::vector<std::ptrdiff_t> left(n);  // how many that nobody holds yet each ball holds
    std::transform(held_by.begin(), held_by.end(), left.begin(),
                   [](const auto& points_of) { return points_of.size(); });
    std::vector<char> done(wanted.size());
    std::vector<int> chosen;
    for (;;) {
        int best = -1;
        for (int b = 0; b < n; ++b) {
            if (left[b] == 0) continue;
            if (best < 0 || std::pair(left[b], axis.radii(b)) > std::pair(left[best], axis.radii(best))) best = b;
        }
        if (best < 0) return chosen;
        chosen.push_back(best);
        for (int p : held_by[best]) {
            if (std::exchange(done[p], 1)) continue;
            for (int b : holders[p]) --left[b];
        }
    }
}

}  // namespace

std::vector<Sphere> make_spheres(const PlacementBody& body, const mesh::SurfaceTree& tree,
                                 const std::vector<mesh::Region>& supports, const std::vector<Site>& sites,
                                 double spacing) {
    std::vector<Sphere> spheres;
    for (const Site& site : sites) {
        Sphere sphere;
        sphere.center = site.at;
        sphere.held = site.held;
        const mesh::SurfacePoint nearest = tree.closest(site.at);
        const Neighborhood& around = body.core.of(site.tet);
        const bool at_support = site.held || mesh::contains(supports, nearest.position);
        sphere.radius = at_support ? around.radius : nearest.distance;
        const double largest = (site.held ? 0.5 : overlap) * spacing;
        if (around.dimensions > 1 && !site.extra) sphere.radius = std::min(sphere.radius, largest);
        spheres.push_back(sphere);
    }
    return spheres;
}

Eigen::VectorXd outside(const std::vector<Sphere>& spheres, const Points& points) {
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
    for (const Sphere& sphere : spheres) {
        const Eigen::RowVector3d center = sphere.center;
        distance = distance.cwiseMin(((points.rowwise() - center).rowwise().norm().array() - sphere.radius).matrix());
    }
    return distance;
}

void swell(const Points& points, double delta, std::vector<Sphere>& spheres) {
    const std::vector<Sphere> before = spheres;
    for (Eigen::Index p = 0; p < points.rows(); ++p) {
        const Vec3 point = points.row(p);
        std::size_t nearest = 0;
        double gap = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < before.size(); ++i) {
            const double d = (before[i].center - point).norm() - before[i].radius;
            if (d >= gap) continue;
            gap = d;
            nearest = i;
        }
        const double growth = gap - 0.999 * delta;
        if (growth > swelling * delta) continue;
        spheres[nearest].radius = std::max(spheres[nearest].radius, before[nearest].radius + growth);
    }
}

std::vector<Site> covering_sites(const PlacementBody& body, const std::vector<mesh::Region>& supports,
                                 const std::vector<Site>& sites, const std::vector<Sphere>& spheres,
                                 const Points& points, double delta, double gap) {
    std::vector<char> taken(body.interface.held), allowed;
    for (const Site& site : sites) taken[site.tet] = 1;
    for (Eigen::Index ball = 0; ball < body.axis.radii.size(); ++ball) {
        const Vec3 center = body.axis.centers.row(ball);
        const bool apart =
            std::none_of(sites.begin(), sites.end(), [&](const Site& site) { return (site.at - center).norm() < gap; });
        allowed.push_back(apart && !mesh::contains(supports, center));
    }
    const Eigen::VectorXd distance = outside(spheres, points);
    std::vector<int> uncovered;
    for (int p = 0; p < points.rows(); ++p) {
        if (distance(p) > delta) uncovered.push_back(p);
    }

    std::vector<Site> added;
    for (int ball : cover(body.axis, allowed, points, uncovered, (1 + 0.9 * swelling) * delta)) {
        const Eigen::RowVector3d center = body.axis.centers.row(ball);
        // The nearest tetrahedron that is still to be had.
        Eigen::VectorXd squares = (body.graph.centers.rowwise() - center).rowwise().squaredNorm();
        for (Eigen::Index t = 0; t < squares.size(); ++t) {
            if (taken[t]) squares(t) = std::numeric_limits<double>::infinity();
        }
        Eigen::Index tet = 0;
        if (!std::isfinite(squares.minCoeff(&tet))) break;
        taken[tet] = 1;
        added.push_back({center, static_cast<int>(tet), false, true});
    }
    return added;
}

}  // namespace palpate::skeleton
