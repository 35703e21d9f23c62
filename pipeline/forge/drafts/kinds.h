#pragma once

#include <vector>

#include "pipeline/forge/draft.h"
#include "pipeline/forge/drafts/told.h"

namespace palpate::pipeline {

/// An effect whose numbers can be drawn.
struct DraftKind {
    std::string name;
    std::vector<Draft> (*draw)(Drawing&, const Told&);
    std::vector<skeleton::KnownParameter> numbers = {};  // of a fault of the measurement; effects of a body have them
                                                         // from skeleton::find_known_effect
};

const std::vector<DraftKind>& body_kinds();         // what acts on a whole body
const std::vector<DraftKind>& material_kinds();     // what its material does
const std::vector<DraftKind>& placed_kinds();       // what sits somewhere: inclusion, contact
const std::vector<DraftKind>& measurement_kinds();  // faults of the readings

Vec3 random_direction(identify::RandomStream& random);

}  // namespace palpate::pipeline
