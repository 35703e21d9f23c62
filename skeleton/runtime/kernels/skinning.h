#pragma once

#include <vector>

#include "skeleton/model/model.h"
#include "skeleton/runtime/kernels/tables.h"

namespace palpate::runtime {

/// A skin laid out to follow the spheres at display rates, in single precision: eight vertices side by side, those with
/// as many shares together. The law is that of skeleton::CarriedPoint.
class Skinning {
public:
    explicit Skinning(const skeleton::Model& model);

    /// Positions of the vertices (x, y, z each) [mm], by the spheres' poses. Error: about 1e-6 of the body's size.
    void follow(const double* pose, float* positions);

    static constexpr int width = 8;
    /// Eight vertices: their numbers, and a block of shares that begin at `first`.
    struct alignas(64) Batch {
        float c[3][width];  // rest less mean centre and all A_i Y_i: what is left to be added up
        int vertex[width];  // -1: none
        int first, shares;
    };
    struct alignas(64) Shares {
        int sphere[width];
        float w[width], A[9][width], B[9][width];  // B twice
    };

private:
    std::vector<Batch, Aligned<Batch>> batches_;
    std::vector<Shares, Aligned<Shares>> shares_;
    std::vector<float, Aligned<float>> pose_;  // as the rows, in single precision
};

}  // namespace palpate::runtime
