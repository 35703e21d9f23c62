#pragma once

#include <array>

#include "skeleton/links/fibres/link_fibre.h"

namespace palpate::skeleton {

/// Area and second moments of the section that a full link stands for; sd_1, sd_2: how far it reaches along its axes 1
/// and 2 [mm].
struct SectionShape {
    double area = 1, sd_1 = 0, sd_2 = 0;
};
SectionShape section_shape(const Link& link);

/// Where a section is sampled along its axes 1 and 2 [mm], each place with the same share of it: as fibres are, in an
/// ellipse of its moments.
using SectionPlaces = std::array<Eigen::Vector2d, fibres_per_link>;
SectionPlaces section_places(const SectionShape& shape);

}  // namespace palpate::skeleton
