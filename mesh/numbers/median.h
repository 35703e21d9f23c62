#pragma once

#include <algorithm>
#include <vector>

namespace palpate::mesh {

/// The middle one in rising order, of an even number the upper of the two in the middle: always one of the values.
/// @pre not empty.
template <typename Value>
Value upper_median(std::vector<Value> values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::ranges::nth_element(values, middle);
    return *middle;
}

}  // namespace palpate::mesh
