#pragma once

#include <vector>

#include "identify/inference/domains/force/force_domain.h"
#include "identify/measurements/field.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// The rotation and translation that carry points best onto others (m x 3), by least squares: y = R (x - c) + d with c
/// the mean of x and d that of y. [Kabsch 1976]
struct RigidFit {
    Mat3 R = Mat3::Identity();
    Vec3 c = Vec3::Zero(), d = Vec3::Zero();
    bool unique = false;  // three points or more that are not in line
};
RigidFit fit_rigid(const Points& x, const Points& y);

/// The spheres in a measured state, as far as they are known; held spheres stand at rest.
struct NodeConfiguration {
    skeleton::State state;
    std::vector<char> known;  // of each sphere

    bool complete() const;
};

/// From markers: a sphere is known where three markers or more, not in line, hang on it alone.
NodeConfiguration configuration_of_markers(const skeleton::Model& model, const MeasurementSet& set,
                                           const LoadState& state);

/// From a full field: the mean displacement of the material round a sphere, in a ball of its radius but no more than
/// half the way to the next sphere, and the rotation in the polar decomposition of its mean deformation.
NodeConfiguration configuration_of_field(const skeleton::Model& model, const Field& field);

/// The loaded states of a set in which all spheres are known, from the field where there is one, else from the markers.
/// @throws InvalidInput when an effect of the model moves the held spheres: where they stand is not measured.
std::vector<MeasuredConfiguration> measured_configurations(const skeleton::Model& model, const MeasurementSet& set);

}  // namespace palpate::identify
