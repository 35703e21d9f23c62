#pragma once

#include <vector>

#include "skeleton/model/state.h"

namespace palpate::skeleton {

// What a skeleton is after its material has grown by a factor 1 + growth in every free length since its rest shape was
// taken (Effects::growth). Its spheres begin where they rest; stiffnesses stay what they are.

/// Links that rest at their grown length.
std::vector<Link> grown(std::vector<Link> links, double growth);

/// The rest shape as large as it has grown, about the origin: where no link is strained.
State grown(State rest, double growth);

/// Where a search for an equilibrium begins: as grown, about the middle of what is held, which stays.
State grown_start(const Model& model, double growth);

/// A point that hangs as far out as it has grown to: where the spheres that carry it part evenly by that factor it
/// does, too, whatever of it `follow` tells.
Attachment grown(Attachment point, const State& rest, double growth);

}  // namespace palpate::skeleton
