#pragma once

#include <vector>

#include "mesh/types.h"

namespace palpate::runtime {

/// Rows of poses as vectors and matrices.
struct Poses {
    std::vector<Vec3> x;  // [mm]
    std::vector<Mat3> R;

    explicit Poses(std::size_t n) : x(n), R(n) {}
    void assign(const double* pose);
};

}  // namespace palpate::runtime
