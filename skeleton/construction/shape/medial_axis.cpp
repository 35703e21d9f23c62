#include "skeleton/construction/shape/medial_axis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace palpate::skeleton {
namespace {

// Seen from a true medial centre the two points that its ball touches lie further apart than this, and where they are
// closer to each other than two samples are, than that: bumps of the surface are no walls.
constexpr double least_angle = 0.6, least_angle_nearby = 1.8;  // [rad]

constexpr int most_cuts = 200;    // of a triangle's side: 40,000 samples of one, however small the spacing is
constexpr int most_shrinks = 30;  // a ball that shrinks longer does so by noise: what is left of it tells the radius
constexpr double hardly_nearer = 1e-4;  // of the radius: a surface that comes no nearer than this touches the ball
constexpr double beside_sample =
    1e-12;  // of the radius: what lies no higher over the sample lies beside it, by rounding

// Balls of whose radius the surface cuts off more than this, or that hardly leave it, as a share of the largest that
// the body's box could hold, are noise of the facets.
constexpr double uncut = 0.7, least_ball_of_box = 1e-3;

struct Sample {
    Vec3 point, inward;
};

// Small triangles that look about the same way within a cell of space; large ones are cut first.
class Patches {
public:
    explicit Patches(double spacing) : spacing_(spacing) {}

    void add(const Vec3& point, const Vec3& area) {
        Eigen::Index axis = 0;
        area.cwiseAbs().maxCoeff(&axis);
        Key key{0, 0, 0, static_cast<int>(area(axis) > 0 ? axis : axis + 3)};
        for (int k = 0; k < 3; ++k) key[k] = static_cast<int>(std::floor(point(k) / spacing_));
        Patch& patch = patches_[key];
        patch.area += area;
        patch.middle += area.norm() * point;
        patch.weight += area.norm();
    }

    // The middle of each patch, and where it looks on the whole.
    std::vector<Sample> samples(const mesh::SurfaceTree& tree) const {
        std::vector<Sample> samples;
        for (const auto& [key, patch] : patches_) {
            samples.push_back({tree.closest(patch.middle / patch.weight).position, -patch.area.normalized()});
        }
        return samples;
    }

private:
    using Key = std::array<int, 4>;  // cell and side
    struct Patch {
        Vec3 area = Vec3::Zero(), middle = Vec3::Zero();
        double weight = 0;
    };
    double spacing_;
    std::map<Key, Patch> patches_;
};

std::vector<Sample> sample_surface(const mesh::Surface& surface, const mesh::SurfaceTree& tree, double spacing) {
    Patches patches(spacing);
    for (Eigen::Index f = 0; f < surface.triangles.rows(); ++f) {
        const Vec3 a = surface.vertices.row(surface.triangles(f, 0));
        const Vec3 u = Vec3(surface.vertices.row(surface.triangles(f, 1))) - a;
        const Vec3 v = Vec3(surface.vertices.row(surface.triangles(f, 2))) - a;
        const Vec3 area = u.cross(v) / 2;
        if (!(area.norm() > 0)) continue;
        // Into k x k equal triangles that are smaller than the cells.
        const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
        const int k = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, most_cuts);
        for (int i = 0; i < k; ++i) {
            for (int j = 0; j < 2 * (k - i) - 1; ++j) {
                // Upright and upside-down triangles of strip i in turn.
                const int pair = j / 2;
                const double third = (j % 2 == 0 ? 1. : 2.) / 3;
                const double s = (i + third) / k;
                const double t = (pair + third) / k;
                patches.add(a + s * u + t * v, area / (k * k));
            }
        }
    }
    return patches.samples(tree);
}

// The radius of the largest ball that touches the surface at the sample from inside, at most `radius`.
double shrink(const mesh::SurfaceTree& tree, const Sample& sample, double spacing, double radius) {
    for (int step = 0; step < most_shrinks; ++step) {
        const Vec3 center = sample.point + radius * sample.inward;
        const mesh::SurfacePoint hit = tree.closest(center);
        if (hit.distance > radius * (1 - hardly_nearer)) break;
        // The ball through both points with its centre on the sample's normal: |d|^2 = 2 r d.n.
        const Vec3 d = hit.position - sample.point;
        const double height = d.dot(sample.inward);
        if (!(height > beside_sample * radius)) break;
        const double smaller = d.squaredNorm() / (2 * height);
        const Vec3 next = sample.point + smaller * sample.inward;
        const double cosine = (sample.point - next).normalized().dot((hit.position - next).normalized());
        const double least = d.norm() < spacing ? least_angle_nearby : least_angle;
        if (step > 0 && std::acos(std::clamp(cosine, -1., 1.)) < least) break;
        radius = smaller;
    }
    return radius;
}

}  // namespace

MedialAxis medial_axis(const mesh::Surface& surface, const mesh::SurfaceTree& tree, double spacing) {
    const double largest = mesh::bounding_box(surface.vertices).diagonal() / 2;
    std::vector<Vec3> centers, touching;
    std::vector<double> radii;
    for (const Sample& sample : sample_surface(surface, tree, spacing)) {
        const double grown = shrink(tree, sample, spacing, largest);
        const Vec3 center = sample.point + grown * sample.inward;
        const mesh::SurfacePoint nearest = tree.closest(center);
        const double radius = nearest.distance;
        if (radius < uncut * grown || radius < least_ball_of_box * largest || !tree.inside(center)) continue;
        centers.push_back(center);
        radii.push_back(radius);
        touching.push_back(nearest.position);
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
