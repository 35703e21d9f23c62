#pragma once

#include <vector>

#include "fem/effects/material/growth.h"
#include "skeleton/model/link_pose.h"

namespace palpate::skeleton {

// What a skeleton is after its material has grown in every free length since its rest shape was taken. Its spheres
// begin where they rest; stiffnesses stay what they are.

/// Links that rest at their grown length.
std::vector<Link> grown_links(const Model& model, const fem::Growth& growth);

/// Each link by itself where nothing strains it: as long as it has grown (L).
std::vector<LinkPose> natural_poses(const Model& model, const fem::Growth& growth);

/// Where a search for an equilibrium begins: as grown everywhere, about the middle of what is held, which stays.
State grown_start(const Model& model, const fem::Growth& growth);

/// A point that hangs as far out as it has grown to: where the spheres that carry it part evenly by that factor it
/// does, too, whatever of it `follow` tells.
Attachment grown(Attachment point, const State& rest, const fem::Growth& growth);

}  // namespace palpate::skeleton
