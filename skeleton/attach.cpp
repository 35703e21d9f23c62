#include <algorithm>
#include <cassert>
#include <limits>

#include "skeleton/model.h"

namespace palpate::skeleton {

namespace {

struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  // less the radius there; negative inside
    int a = 0, b = 0;
    double t = 0;
};

// Nearest in order: the first of equals stays.
void offer(Nearest& nearest, double distance, int a, int b, double t) {
    if (distance < nearest.distance) nearest = {distance, a, b, t};
}

Nearest nearest_link_or_sphere(const Model& model, const Vec3& point) {
    Nearest nearest;
    for (const Link& link : model.links) {
        const Sphere& a = model.spheres[link.a];
        const Sphere& b = model.spheres[link.b];
        const Vec3 axis = b.center - a.center;
        const double t = std::clamp((point - a.center).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
        const double radius = (1 - t) * a.radius + t * b.radius;
        offer(nearest, (point - a.center - t * axis).norm() - radius, link.a, link.b, t);
    }
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        const Sphere& sphere = model.spheres[i];
        offer(nearest, (point - sphere.center).norm() - sphere.radius, i, i, 0);
    }
    return nearest;
}

}  // namespace

Attachment attach(const Model& model, const Vec3& point) { return attach(model, point, point); }

Attachment attach(const Model& model, const Vec3& anchor, const Vec3& point) {
    assert(!model.spheres.empty());
    const Nearest nearest = nearest_link_or_sphere(model, anchor);
    return {nearest.a, nearest.b, nearest.t, point};
}

}  // namespace palpate::skeleton
