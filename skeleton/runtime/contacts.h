#pragma once

#include <vector>

#include "skeleton/runtime/carried.h"

namespace palpate::runtime {

/// Where a body is held from outside: a point of its skin, or a patch, and what is done to it.
struct Contact {
    enum class Does { nothing, push, drag };

    bool used = false;
    Does does = Does::nothing;
    Carried at;
    Vec3 dead = Vec3::Zero();    // push [N]
    Vec3 target = Vec3::Zero();  // drag [mm]
    double stiffness = 0;        // drag [N/mm]

    // Of a body that creeps, which bears gain * force + crept: see creep.h.
    bool creeps = true;
    double gain = 1;
    Vec3 crept = Vec3::Zero();  // [N]
    Vec3 late = Vec3::Zero();   // the force as it was, smoothed over the time of the creep [N]
    double forgotten = 0;       // where that is the end of it, once released [N]

    // Of the dent that it presses: the outward normal at rest, vertices and the kernels' means over the patch there.
    Vec3 normal = Vec3::Zero();
    std::vector<int> dented;
    std::vector<Eigen::Vector3f> kernels;

    /// Is it held, or does the body still recover from it?
    bool acts() const { return used || !late.isZero(0); }
    /// What acts from outside, `at` being placed [N].
    Vec3 force() const {
        if (does == Does::drag) return stiffness * (target - at.x());
        return does == Does::push ? dead : Vec3(Vec3::Zero());
    }
    /// What the body bears [N].
    Vec3 borne() const { return gain * force() + crept; }
};

/// Sets a contact on a model's skin: at the point nearest to `point` of the skin as it stands (x, y, z of each vertex,
/// with the spheres at `pose`), spread over what of it lies within `radius` at rest.
void place_contact(const skeleton::Model& model, const std::vector<float>& skin, const double* pose, const Vec3& point,
                   double radius, Contact& contact);

/// Adds to the skin what a contact dents it by.
void add_dent(const skeleton::Model& model, const Contact& contact, std::vector<float>& skin);

}  // namespace palpate::runtime
