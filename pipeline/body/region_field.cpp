#include "pipeline/body/region_field.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/regions/region_finder.h"
#include "skeleton/construction/properties/region_stiffness.h"

namespace palpate::pipeline {

std::vector<std::string> take_regions(const std::vector<mesh::MaterialRegion>& regions, double young,
                                      skeleton::Model& model) {
    std::vector<std::string> notes;
    std::vector<mesh::Surface> surfaces;
    std::vector<double> shares;
    for (const mesh::MaterialRegion& region : regions) {
        surfaces.push_back(region.surface);
        shares.push_back(region.young.value_or(young) / young);
        notes.push_back(
            region.young
                ? fmt::format("Region '{}' is {:.3g} times as stiff as the rest, and so are the skeleton's sections "
                              "there.",
                              region.name, shares.back())
                : fmt::format("Region '{}' is of unknown stiffness: the skeleton begins with that of the rest there "
                              "('--parameters links' lets its links differ).",
                              region.name));
    }
    if (std::ranges::all_of(regions, [](const mesh::MaterialRegion& region) { return !region.young; })) return notes;
    if (std::ranges::any_of(model.links, [](const skeleton::Link& link) { return !link.section; })) {
        notes.emplace_back(
            "Links of the paper's kind have no sections that regions could be in: they are those of one material "
            "('--links full' has them).");
        return notes;
    }
    const mesh::RegionFinder region_at(surfaces);
    skeleton::apply_field(
        [&](const Vec3& place) {
            const int region = region_at(place);
            return region < 0 ? 1.0 : shares[static_cast<std::size_t>(region)];
        },
        model);
    return notes;
}

}  // namespace palpate::pipeline
