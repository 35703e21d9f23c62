#include "mesh/regions/labels.h"

#include <cassert>

namespace palpate::mesh {

std::vector<int> labels_of(const std::vector<MaterialRegion>& regions) {
    std::vector<int> labels;
    for (const MaterialRegion& region : regions)
        if (region.label) labels.push_back(*region.label);
    return labels;
}

void take_parts(const std::vector<Surface>& parts, double scale, std::vector<MaterialRegion>& regions) {
    auto part = parts.begin();
    for (MaterialRegion& region : regions) {
        if (!region.label) continue;
        assert(part != parts.end());
        region.surface = *part++;
        region.surface.vertices *= scale;
    }
}

}  // namespace palpate::mesh
