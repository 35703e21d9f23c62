#include "mesh/geometry/local_thickness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mesh/geometry/surface_tree.h"

namespace palpate::mesh {
namespace {

/// The largest ball that touches the surface at a point from inside; `inward` of unit length, `most` of its radius.
double radius_of_touching_ball(const SurfaceTree& tree, const Vec3& point, const Vec3& inward, double most) {
    constexpr int rounds = 30;         // each shrinks the ball; so many end what would shrink by ever less
    constexpr double touching = 1e-3;  // of the radius: nothing reaches deeper into the ball but by rounding
    double r = most;
    for (int round = 0; round < rounds; ++round) {
        const Vec3 centre = point + r * inward;
        const SurfacePoint nearest = tree.closest(centre);
        if (nearest.distance >= (1 - touching) * r) break;
        const Vec3 across = nearest.position - point;
        const double depth = inward.dot(across);
        if (!(depth > 0)) break;  // it meets the surface around the point itself
        r = across.squaredNorm() / (2 * depth);
    }
    return r;
}

}  // namespace

double local_thickness(const Surface& surface) {
    constexpr int samples = 200;  // a quantile of 0.9 is that of 0.86 to 0.94 then, within two standard deviations
    constexpr double most = 0.9;  // of the skin
    const SurfaceTree tree(surface);
    const double size = bounding_box(surface.vertices).longest_side();
    struct Ball {
        double diameter, area;
    };
    std::vector<Ball> balls;
    const Eigen::Index count = surface.triangles.rows();
    double skin = 0;
    for (int i = 0; i < samples; ++i) {
        // Multiples of the golden ratio: spread evenly over the triangles, and in step with no grid of theirs.
        const double share = std::fmod(std::numbers::phi * (i + 0.5), 1.0);
        const Eigen::Index t = count <= samples ? i : static_cast<Eigen::Index>(share * static_cast<double>(count));
        if (t >= count) break;
        const Vec3 a = surface.vertices.row(surface.triangles(t, 0)), b = surface.vertices.row(surface.triangles(t, 1)),
                   c = surface.vertices.row(surface.triangles(t, 2));
        const Vec3 out = (b - a).cross(c - a);
        const double area = 0.5 * out.norm();
        if (!(area > 0)) continue;
        balls.push_back({2 * radius_of_touching_ball(tree, (a + b + c) / 3, -out.normalized(), size), area});
        skin += area;
    }
    std::ranges::sort(balls, {}, &Ball::diameter);
    double below = 0;
    for (const Ball& ball : balls) {
        below += ball.area;
        if (below >= most * skin) return ball.diameter;
    }
    return 0;
}

}  // namespace palpate::mesh
