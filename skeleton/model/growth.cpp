#include "skeleton/model/growth.h"

namespace palpate::skeleton {

State grown_start(const Model& model, const fem::Growth& growth) {
    State start = rest_state(model);
    if (growth.everywhere == 0) return start;
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
        if (!sphere.held)
            start.x.row(static_cast<Eigen::Index>(i)) += growth.everywhere * (sphere.center - middle).transpose();
    }
    return start;
}

Attachment grown(Attachment point, const State& rest, const fem::Growth& growth) {
    if (growth.none()) return point;
    Vec3 mean = Vec3::Zero();
    for (const SphereInfluence& share : point.shares) mean += share.weight * rest.x.row(share.sphere).transpose();
    // What the point moves by against the spheres' mean as they part, see CarriedPoint.
    Vec3 followed = Vec3::Zero();
    for (const SphereInfluence& share : point.shares) {
        const Vec3 arm = rest.x.row(share.sphere).transpose() - mean;
        followed += share.follow.leftCols<3>() * arm - share.weight * arm;
    }
    point.rest += growth.at(point.rest) * (point.rest - mean - followed);
    return point;
}

}  // namespace palpate::skeleton
