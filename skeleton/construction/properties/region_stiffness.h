#pragma once

#include <functional>

#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// How many times as stiff as the rest a body is at a place [-], above 0.
using StiffnessField = std::function<double(const Vec3& place)>;

/// Gives full links and spheres the stiffness that they have in a body of several materials.
///
/// Each link's section is taken as an ellipse of its area and moments, cut into slices along the link: a slice bears
/// the integrals of the field over it, about its own neutral axis, and softnesses of slices add up, so that a bone
/// along a link bears all, and a soft gap across it gives all. A sphere's volume term has the Reuss mean over the ball.
/// Links of the paper's kind, which have no section, stay as they are.
void apply_field(const StiffnessField& field, Model& model);

}  // namespace palpate::skeleton
