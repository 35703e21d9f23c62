#include "skeleton/model/growth.h"

namespace palpate::skeleton {

std::vector<Link> grown(std::vector<Link> links, double growth) {
    for (Link& link : links) link.length *= 1 + growth;
    return links;
}

State grown(State rest, double growth) {
    rest.x *= 1 + growth;
    return rest;
}

State grown_start(const Model& model, double growth) {
    State start = rest_state(model);
    if (growth == 0) return start;
    Vec3 middle = Vec3::Zero();
    int held = 0;
    for (const Sphere& sphere : model.spheres) {
        if (!sphere.held) continue;
        middle += sphere.center;
        ++held;
    }
    if (held > 0) middle /= held;
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const Sphere& sphere = model.spheres[i];
        if (!sphere.held) start.x.row(static_cast<Eigen::Index>(i)) += growth * (sphere.center - middle).transpose();
    }
    return start;
}

Attachment grown(Attachment point, const State& rest, double growth) {
    if (growth == 0) return point;
    Vec3 mean = Vec3::Zero();
    for (const SphereInfluence& share : point.shares) mean += share.weight * rest.x.row(share.sphere).transpose();
    // What the point moves by against the spheres' mean as they part, see CarriedPoint.
    Vec3 followed = Vec3::Zero();
    for (const SphereInfluence& share : point.shares) {
        const Vec3 arm = rest.x.row(share.sphere).transpose() - mean;
        followed += share.follow.leftCols<3>() * arm - share.weight * arm;
    }
    point.rest += growth * (point.rest - mean - followed);
    return point;
}

}  // namespace palpate::skeleton
