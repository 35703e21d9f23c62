#pragma once

#include <cstddef>
#include <vector>

namespace palpate::fem {

/// Which parts of a body are of materials of their own.
struct ElementRegions {
    std::vector<int> of_element;  // the region of each element, -1: it is of the body's own material; empty: all are
    std::vector<double> density;  // of each region, as a share of the body's own [-]
    int count() const { return static_cast<int>(density.size()); }
    /// Its place among the materials: 0, the body's own, then the regions'.
    std::size_t group(std::size_t element) const {
        return of_element.empty() ? 0 : static_cast<std::size_t>(of_element[element] + 1);
    }
};

}  // namespace palpate::fem
