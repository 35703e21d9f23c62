#include "skeleton/model/link_modulus.h"

#include <algorithm>
#include <numbers>
#include <vector>

namespace palpate::skeleton {

double link_modulus(const Model& model) {
    std::vector<double> all;
    for (const Link& link : model.links) {
        const double radius = std::min(model.spheres[link.a].radius, model.spheres[link.b].radius);
        const double section = std::numbers::pi * radius * radius;
        if (section > 0) all.push_back(link.stiffness[0] * link.length / section);
    }
    if (all.empty()) return 1;
    const auto middle = all.begin() + std::ssize(all) / 2;
    std::nth_element(all.begin(), middle, all.end());
    return *middle > 0 ? *middle : 1;
}

}  // namespace palpate::skeleton
