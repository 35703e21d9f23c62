#include "skeleton/links/sections/section_shape.h"

#include <cmath>

namespace palpate::skeleton {

SectionShape section_shape(const Link& link) {
    constexpr int flexion = static_cast<int>(Stiffness::flexion), flexion_2 = static_cast<int>(Stiffness::flexion_2);
    SectionShape shape;
    const LinkSection& section = *link.section;
    if (section.area > 0) shape.area = section.area;
    // The flexions are as the moments are, whatever their common multiplier. A limb's radius of gyration is that of
    // their geometric mean, about sqrt(A / 12) whether its section is round or flat; a plate's is that of the smaller.
    const double k_1 = link.stiffness[flexion], k_2 = link.stiffness[flexion_2];
    const double ratio = k_1 > 0 && k_2 > 0 ? std::sqrt(std::sqrt(k_1 / k_2)) : 1, gyration = radius_of_gyration(link);
    const bool plate = section.area > 0 && gyration * std::sqrt(ratio) < std::sqrt(section.area / 12);
    shape.sd_2 = plate ? gyration : gyration / ratio;
    shape.sd_1 = shape.sd_2 * ratio * ratio;
    return shape;
}

SectionPlaces section_places(const SectionShape& shape) {
    Link round;
    round.gyration = 1;
    round.section = LinkSection();
    const FibreOffsets offsets = fibre_offsets(round, Vec3::UnitX());
    SectionPlaces places;
    for (int j = 0; j < fibres_per_link; ++j) places[j] << shape.sd_1 * offsets[j].y(), shape.sd_2 * offsets[j].z();
    return places;
}

}  // namespace palpate::skeleton
