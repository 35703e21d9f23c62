#pragma once

#include <vector>

#include "fem/effects/point/point_potential.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Points of a skeleton and what each weighs.
struct PointSet {
    std::vector<Attachment> at;  // (n)
    Eigen::VectorXd weights;     // (n), as fem::ActsOn tells: [tonne], [mm^2], or shares that add up to 1
};

/// The points that an effect acts on.
///   material: the spheres' centres with their masses
///   surface: the skin's vertices, each with a third of the triangles that meet there
///   support: the skin's vertices that a support holds, shares by area, each rigidly on the nearest held sphere. A held
///     sphere that those on it do not keep from turning (none, few or in line) bears six points more, where the axes
///     meet it, which share the area of its section, pi r^2: a support within the body has no skin. Held spheres that
///     no link joins to anything bear nothing, unless there are no others.
/// @throws InvalidInput when the model has none: no skin, or no held sphere.
PointSet point_set(const Model& model, fem::ActsOn acts_on);

}  // namespace palpate::skeleton
