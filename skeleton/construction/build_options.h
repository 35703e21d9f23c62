#pragma once

#include "skeleton/construction/properties/link_kind.h"

namespace palpate::skeleton {

struct BuildOptions {
    static constexpr int most_spheres = 20000, most_zones = 1000;

    int spheres = 0;  // free spheres, [1, most_spheres]; 0: by the body's shape, and as many as the coverage asks for
    double coverage = 0;  // [mm] no free surface vertex further outside the spheres; 0: 5 % of the longest side
    LinkKind links = LinkKind::full;
    bool condense = true;  // the skin follows the body in finite elements; else the nearest link or sphere
    int zones = 1;         // [1, most_zones]: links are split in so many along the body, from the support outwards
    void validate() const;
};

}  // namespace palpate::skeleton
