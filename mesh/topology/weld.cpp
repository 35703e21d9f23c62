#include "mesh/topology/weld.h"

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace palpate::mesh {
namespace {

/// Cells as wide as the distance: what is near lies in the same cell or in one of the 26 round it.
class Grid {
public:
    Grid(const Vec3& origin, double width) : origin_(origin), width_(width) {}

    /// The first point given that lies within the width of this one, which is kept if there is none.
    int find_or_add(const Vec3& point) {
        const Cell cell = ((point - origin_) / width_).array().floor().cast<std::int64_t>();
        int found = -1;
        for (int i = -1; i <= 1; ++i)
            for (int j = -1; j <= 1; ++j)
                for (int k = -1; k <= 1; ++k) {
                    const auto bucket = cells_.find(hash(cell + Cell(i, j, k)));
                    if (bucket == cells_.end()) continue;
                    for (const int candidate : bucket->second)
                        if ((kept_[static_cast<std::size_t>(candidate)] - point).norm() <= width_ &&
                            (found < 0 || candidate < found))
                            found = candidate;
                }
        if (found >= 0) return found;
        kept_.push_back(point);
        cells_[hash(cell)].push_back(static_cast<int>(kept_.size()) - 1);
        return static_cast<int>(kept_.size()) - 1;
    }

    const std::vector<Vec3>& kept() const { return kept_; }

private:
    using Cell = Eigen::Array<std::int64_t, 3, 1>;
    static std::uint64_t hash(const Cell& cell) {
        std::uint64_t value = 0;
        for (const std::int64_t part : cell) value = (value ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
        return value;
    }

    Vec3 origin_;
    double width_;
    std::vector<Vec3> kept_;
    std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace

WeldResult weld(const Surface& surface, double distance) {
    WeldResult result;
    result.surface.triangles.resize(surface.triangles.rows(), 3);
    if (surface.triangles.rows() == 0) return result;

    // A width of nothing would divide by zero; the smallest one welds equal points only.
    const Box box = bounding_box(surface.vertices);
    Grid grid(box.min, std::max(distance, 1e-12 * box.diagonal() + 1e-300));
    std::vector<int> row_of(static_cast<std::size_t>(surface.vertices.rows()), -1);
    int used = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i) {
            int& row = row_of[static_cast<std::size_t>(surface.triangles(t, i))];
            if (row < 0) {
                row = grid.find_or_add(surface.vertices.row(surface.triangles(t, i)));
                ++used;
            }
            result.surface.triangles(t, i) = row;
        }
    const auto& kept = grid.kept();
    result.merged = used - static_cast<int>(kept.size());
    result.surface.vertices.resize(static_cast<Eigen::Index>(kept.size()), 3);
    for (std::size_t v = 0; v < kept.size(); ++v) result.surface.vertices.row(static_cast<Eigen::Index>(v)) = kept[v];
    return result;
}

}  // namespace palpate::mesh
