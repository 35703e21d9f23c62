#pragma once

#include "fem/effects/material/growth.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

// What a skeleton is after its material has grown in every free length since its rest shape was taken, but for its
// links (links/placed/grown_links.h).

/// Where a search for an equilibrium begins: as grown everywhere, about the middle of what is held, which stays.
State grown_start(const Model& model, const fem::Growth& growth);

/// A point that hangs as far out as it has grown to: where the spheres that carry it part evenly by that factor it
/// does, too, whatever of it `follow` tells.
Attachment grown(Attachment point, const State& rest, const fem::Growth& growth);

}  // namespace palpate::skeleton
