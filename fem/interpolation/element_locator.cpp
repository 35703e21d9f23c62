#include "fem/interpolation/element_locator.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "fem/elements/shape.h"

namespace palpate::fem {

namespace {

Eigen::Vector4d barycentric(const Vec3& tail) { return {1 - tail.sum(), tail.x(), tail.y(), tail.z()}; }

template <int nodes>
std::optional<Eigen::Vector4d> invert(const Eigen::Matrix<double, nodes, 3>& X, const Vec3& point) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = X.row(k + 1) - X.row(0);
    const Vec3 origin = X.row(0);
    Vec3 tail = edges.inverse() * (point - origin);
    if constexpr (nodes == 10) {
        constexpr double tolerance = 1e-13;  // of the coordinates, which are of order 1
        constexpr int iterations = 30;
        constexpr double far_off =
            1e3;  // of the coordinates: the point is not in this element, and the map folds there
        for (int k = 0; k < iterations; ++k) {
            const Eigen::Vector4d l = barycentric(tail);
            const Vec3 miss = X.transpose() * shape<4, nodes>(l) - point;
            const Mat3 J = X.transpose() * shape_gradient<4, nodes>(l);
            const Vec3 step = J.inverse() * miss;
            tail -= step;
            if (!(tail.norm() < far_off)) return std::nullopt;
            if (step.norm() < tolerance * (1 + tail.norm())) return barycentric(tail);
        }
        return std::nullopt;
    }
    return barycentric(tail);
}

/// The box of an element's nodes, widened where it is curved: midside nodes may bow out, and the edge beyond them by
/// no more than as much again.
mesh::Box element_box(const mesh::VolumeMesh& mesh, int element) {
    mesh::Box box{mesh.nodes.row(mesh.tetrahedra(element, 0)), mesh.nodes.row(mesh.tetrahedra(element, 0))};
    const auto include = [&](const Vec3& x) {
        box.min = box.min.cwiseMin(x);
        box.max = box.max.cwiseMax(x);
    };
    for (Eigen::Index k = 1; k < mesh.tetrahedra.cols(); ++k) {
        Vec3 x = mesh.nodes.row(mesh.tetrahedra(element, k));
        if (k >= 4) {
            // The Bezier point of the edge: elements lie in the hull of these and the corners.
            const auto [a, b] = edge_corners[k - 4];
            x = 2 * x - (mesh.nodes.row(mesh.tetrahedra(element, a)) + mesh.nodes.row(mesh.tetrahedra(element, b)))
                                .transpose() /
                            2;
        }
        include(x);
    }
    const Vec3 rounding = Vec3::Constant(1e-9 * box.diagonal());
    return {box.min - rounding, box.max + rounding};
}

}  // namespace

std::optional<Eigen::Vector4d> local_coordinates(const mesh::VolumeMesh& mesh, int element, const Vec3& point) {
    const auto nodes = mesh.tetrahedra.row(element);
    return mesh.is_quadratic() ? invert<10>(node_positions<10>(mesh.nodes, nodes), point)
                               : invert<4>(node_positions<4>(mesh.nodes, nodes), point);
}

ElementLocator::ElementLocator(const mesh::VolumeMesh& mesh) : mesh_(mesh) {
    const auto m = static_cast<int>(mesh.tetrahedra.rows());
    boxes_.resize(m);
    mesh::Box all = mesh::bounding_box(mesh.nodes);
    for (int e = 0; e < m; ++e) {
        boxes_[e] = element_box(mesh, e);
        all.min = all.min.cwiseMin(boxes_[e].min);
        all.max = all.max.cwiseMax(boxes_[e].max);
    }

    // About one cell an element, and memory for no more than 256^3 where a thin body would ask for more.
    constexpr int most_cells_along = 256;
    min_ = all.min;
    const Vec3 extent = all.extent();
    cell_size_ = std::max(std::cbrt(extent.prod() / m), all.longest_side() / most_cells_along);
    for (int a = 0; a < 3; ++a) cells_(a) = static_cast<int>(extent(a) / cell_size_) + 1;

    // Count, then fill.
    start_.assign(static_cast<std::size_t>(cells_.x()) * cells_.y() * cells_.z() + 1, 0);
    const auto for_each_cell = [&](int e, auto&& visit) {
        const Eigen::Vector3i low = cell_of(boxes_[e].min), high = cell_of(boxes_[e].max);
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                for (int x = low.x(); x <= high.x(); ++x) visit(index_of({x, y, z}));
            }
        }
    };
    for (int e = 0; e < m; ++e) {
        for_each_cell(e, [&](std::size_t cell) { ++start_[cell + 1]; });
    }
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    elements_.resize(start_.back());
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (int e = 0; e < m; ++e) {
        for_each_cell(e, [&](std::size_t cell) { elements_[next[cell]++] = e; });
    }
}

Eigen::Vector3i ElementLocator::cell_of(const Vec3& point) const {
    const Vec3 cell =
        ((point - min_) / cell_size_).cwiseMax(0).cwiseMin((cells_ - Eigen::Vector3i::Ones()).cast<double>());
    return cell.cast<int>();
}

std::size_t ElementLocator::index_of(const Eigen::Vector3i& cell) const {
    return (static_cast<std::size_t>(cell.z()) * cells_.y() + cell.y()) * cells_.x() + cell.x();
}

std::optional<ElementPoint> ElementLocator::find(const Vec3& point) const {
    constexpr double rounding = -1e-9;
    const std::size_t cell = index_of(cell_of(point));
    std::optional<ElementPoint> best;
    double depth = rounding;
    for (int k = start_[cell]; k < start_[cell + 1]; ++k) {
        // where a mesh is far finer than elsewhere, a cell lists thousands
        const mesh::Box& box = boxes_[elements_[k]];
        if ((point.array() < box.min.array()).any() || (point.array() > box.max.array()).any()) continue;
        const auto l = local_coordinates(mesh_, elements_[k], point);
        if (!l || l->minCoeff() < depth) continue;
        // At equal depth the first element stays.
        if (best && l->minCoeff() <= depth) continue;
        depth = l->minCoeff();
        best = ElementPoint{elements_[k], *l};
    }
    return best;
}

}  // namespace palpate::fem
