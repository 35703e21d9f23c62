#pragma once

#include <memory>
#include <vector>

#include "fem/effects/known_effect.h"

namespace palpate::skeleton {

/// Effects in a skeleton's links, of which a solid has none: resistance to twist as a share of the links' flexion, and
/// to shear apart from flexion as a share of their elongation [-].
struct LinkEffects {
    double torsion = 0, shear = 0;
};

/// As one of fem::Effects::of_model.
std::shared_ptr<const fem::ModelSpecificEffect> in_links(const LinkEffects& effects);

/// All that are in force in links; numbers add up.
LinkEffects link_effects(const fem::Effects& effects);

/// Their rows: "torsion", "shear".
std::vector<fem::KnownEffect> known_link_effects();

}  // namespace palpate::skeleton
