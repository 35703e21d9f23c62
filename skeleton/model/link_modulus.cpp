#include "skeleton/model/link_modulus.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "mesh/numbers/median.h"

namespace palpate::skeleton {

double link_modulus(const Model& model) {
    std::vector<double> all;
    for (const Link& link : model.links) {
        const double radius = std::min(model.spheres[link.a].radius, model.spheres[link.b].radius);
        const double section = std::numbers::pi * radius * radius;
        if (section > 0) all.push_back(link.stiffness[0] * link.length / section);
    }
    if (all.empty()) return 1;
    const double median = mesh::upper_median(std::move(all));
    return median > 0 ? median : 1;
}

}  // namespace palpate::skeleton
