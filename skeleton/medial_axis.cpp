#include "skeleton/medial_axis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::skeleton {
namespace {

// Seen from a true medial centre the two points that its ball touches lie further apart than this.
constexpr double least_angle = 0.6;  // [rad]

struct Sample {
    Vec3 point, inward;
};

// The middles of the triangles, those larger than the spacing cut into k x k equal ones.
std::vector<Sample> sample_surface(const mesh::Surface& surface, double spacing) {
    std::vector<Sample> samples;
    for (Eigen::Index f = 0; f < surface.triangles.rows(); ++f) {
        const Vec3 a = surface.vertices.row(surface.triangles(f, 0));
        const Vec3 u = Vec3(surface.vertices.row(surface.triangles(f, 1))) - a;
        const Vec3 v = Vec3(surface.vertices.row(surface.triangles(f, 2))) - a;
        const Vec3 normal = u.cross(v);
        if (!(normal.norm() > 0)) continue;
        const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
        const int k = std::clamp(static_cast<int>(std::ceil(longest / (1.5 * spacing))), 1, 200);
        for (int i = 0; i < k; ++i) {
            for (int j = 0; j < 2 * (k - i) - 1; ++j) {
                // Upright and upside-down triangles of strip i in turn.
                const int pair = j / 2;
                const double third = (j % 2 == 0 ? 1. : 2.) / 3;
                const double s = (i + third) / k;
                const double t = (pair + third) / k;
                samples.push_back({a + s * u + t * v, -normal.normalized()});
            }
        }
    }
    return samples;
}

// The radius of the largest ball that touches the surface at the sample from inside, at most `radius`.
double shrink(const mesh::SurfaceTree& tree, const Sample& sample, double radius) {
    for (int step = 0; step < 30; ++step) {
        const Vec3 center = sample.point + radius * sample.inward;
        const mesh::SurfacePoint hit = tree.closest(center);
        if (hit.distance > radius * (1 - 1e-4)) break;
        // The ball through both points with its centre on the sample's normal: |d|^2 = 2 r d.n.
        const Vec3 d = hit.position - sample.point;
        const double height = d.dot(sample.inward);
        if (!(height > 1e-12 * radius)) break;
        const double smaller = d.squaredNorm() / (2 * height);
        const Vec3 next = sample.point + smaller * sample.inward;
        const double cosine = (sample.point - next).normalized().dot((hit.position - next).normalized());
        if (step > 0 && std::acos(std::clamp(cosine, -1., 1.)) < least_angle) break;
        radius = smaller;
    }
    return radius;
}

}  // namespace

MedialAxis medial_axis(const mesh::Surface& surface, const mesh::SurfaceTree& tree, double spacing) {
    const double largest = mesh::bounding_box(surface.vertices).diagonal() / 2;
    std::vector<Sample> samples = sample_surface(surface, spacing);

    std::vector<Vec3> centers, touching;
    std::vector<double> radii;
    for (const Sample& sample : samples) {
        const double grown = shrink(tree, sample, largest);
        const Vec3 center = sample.point + grown * sample.inward;
        const double radius = tree.closest(center).distance;
        // Balls that the surface cuts deeply, or that hardly leave it, are noise of the facets.
        if (radius < 0.7 * grown || radius < 1e-3 * largest || !tree.inside(center)) continue;
        centers.push_back(center);
        radii.push_back(radius);
        touching.push_back(sample.point);
    }

    MedialAxis axis;
    const auto n = static_cast<Eigen::Index>(centers.size());
    axis.centers.resize(n, 3);
    axis.radii.resize(n);
    axis.touching.resize(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
        axis.centers.row(i) = centers[i];
        axis.radii(i) = radii[i];
        axis.touching.row(i) = touching[i];
    }
    return axis;
}

}  // namespace palpate::skeleton
