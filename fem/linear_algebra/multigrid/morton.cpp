#include "fem/linear_algebra/multigrid/morton.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace palpate::fem {

namespace {

constexpr int bits = 20;  // of each coordinate

/// The bits of three coordinates in turn.
std::uint64_t code(const Eigen::Matrix<std::uint64_t, 1, 3>& cell) {
    std::uint64_t result = 0;
    for (int bit = 0; bit < bits; ++bit) {
        for (int a = 0; a < 3; ++a) result |= ((cell(a) >> bit) & 1) << (3 * bit + a);
    }
    return result;
}

}  // namespace

std::vector<int> morton_order(const Points& points) {
    const Eigen::RowVector3d least = points.colwise().minCoeff();
    const double size = (points.colwise().maxCoeff() - least).maxCoeff();
    const double cells = size > 0 ? ((1 << bits) - 1) / size : 0;
    std::vector<std::uint64_t> codes(points.rows());
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        codes[i] = code(((points.row(i) - least) * cells).cast<std::uint64_t>());
    }
    std::vector<int> order(points.rows());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](int i) { return codes[i]; });
    return order;
}

}  // namespace palpate::fem
