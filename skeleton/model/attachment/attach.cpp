#include "skeleton/model/attachment/attach.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "skeleton/model/state.h"

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

SphereInfluence share_of(const Model& model, int sphere, double weight, const Vec3& rest) {
    SphereInfluence share{.sphere = sphere, .weight = weight};
    share.follow << weight * Mat3::Identity(), -weight * skew(rest - model.spheres[sphere].center);
    return share;
}

}  // namespace

Attachment on_sphere(const Model& model, int sphere, const Vec3& rest) {
    return {{share_of(model, sphere, 1, rest)}, rest};
}

Attachment between(const Model& model, int a, int b, double t, const Vec3& rest) {
    if (a == b || t == 0) return on_sphere(model, a, rest);
    if (t == 1) return on_sphere(model, b, rest);
    return {{share_of(model, a, 1 - t, rest), share_of(model, b, t, rest)}, rest};
}

Attachment blend(std::span<const std::pair<double, const Attachment*>> parts) {
    Attachment mean;
    for (const auto& [weight, part] : parts) {
        if (weight == 0) continue;
        mean.rest += weight * part->rest;
        for (const SphereInfluence& share : part->shares) {
            auto sum = std::ranges::find(mean.shares, share.sphere, &SphereInfluence::sphere);
            if (sum == mean.shares.end()) sum = mean.shares.insert(sum, SphereInfluence{.sphere = share.sphere});
            sum->weight += weight * share.weight;
            sum->follow += weight * share.follow;
        }
    }
    return mean;
}

Attachment moved_to(Attachment attachment, const Vec3& point) {
    const Vec3 arm = point - attachment.rest;
    for (SphereInfluence& share : attachment.shares) share.follow.rightCols<3>() -= share.weight * skew(arm);
    attachment.rest = point;
    return attachment;
}

Attachment attach_to_links(const Model& model, const Vec3& point) {
    assert(!model.spheres.empty());
    const Nearest nearest = nearest_link_or_sphere(model, point);
    return between(model, nearest.a, nearest.b, nearest.t, point);
}

}  // namespace palpate::skeleton
