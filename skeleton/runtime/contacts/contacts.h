#pragma once

#include <vector>

#include "skeleton/runtime/forces/carried.h"

namespace palpate::runtime {

/// Where a body is held from outside: a point of its skin, or a patch, and what is done to it.
struct ContactState {
    enum class Mode { nothing, push, drag };

    bool used = false;
    Mode mode = Mode::nothing;
    RuntimePoint at;
    Vec3 dead = Vec3::Zero();    // push [N]
    Vec3 target = Vec3::Zero();  // drag [mm]
    double stiffness = 0;        // drag [N/mm]

    // Of a body that creeps, which bears gain * force + crept: see creep.h.
    bool creeps = true;
    double gain = 1;
    Vec3 crept = Vec3::Zero();         // [N]
    Vec3 lagged_force = Vec3::Zero();  // the force as it was, smoothed over the time of the creep [N]
    double negligible_force = 0;       // threshold below which a released contact is dropped [N]

    // Of the dent that it presses: the outward normal at rest, vertices and the kernels' means over the patch there.
    Vec3 normal = Vec3::Zero();
    std::vector<int> dented;
    std::vector<Eigen::Vector3f> kernels;

    /// Is it held, or does the body still recover from it?
    bool acts() const { return used || !lagged_force.isZero(0); }
    /// What acts from outside, `at` being placed [N].
    Vec3 force() const {
        if (mode == Mode::drag) return stiffness * (target - at.x());
        return mode == Mode::push ? dead : Vec3(Vec3::Zero());
    }
    /// What the body bears [N].
    Vec3 effective_force() const { return gain * force() + crept; }
};

/// Sets a contact on a model's skin: at the point nearest to `point` of the skin as it stands (x, y, z of each vertex,
/// with the spheres at `pose`), spread over what of it lies within `radius` at rest.
void place_contact(const skeleton::Model& model, const std::vector<float>& skin, const double* pose, const Vec3& point,
                   double radius, ContactState& contact);

/// Adds to the skin what a contact dents it by.
void add_dent(const skeleton::Model& model, const ContactState& contact, std::vector<float>& skin);

}  // namespace palpate::runtime
