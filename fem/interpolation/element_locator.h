#pragma once

#include <optional>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// A point of an element.
struct ElementPoint {
    int element = -1;
    Eigen::Vector4d l = Eigen::Vector4d::Zero();  // barycentric coordinates
};

/// Barycentric coordinates of a point in an element, also outside of it: affine for straight elements, else Newton's
/// method from there. Empty when that does not settle, which happens far outside curved elements only.
std::optional<Eigen::Vector4d> local_coordinates(const mesh::VolumeMesh& mesh, int element, const Vec3& point);

/// Finds the element that holds a point, by a uniform grid that lists the elements of each cell. Keeps a reference to
/// the mesh. Queries are safe from several threads.
class ElementLocator {
public:
    explicit ElementLocator(const mesh::VolumeMesh& mesh);

    /// Empty outside of the body. Points on a border lie in the element that holds them deepest, to rounding.
    std::optional<ElementPoint> find(const Vec3& point) const;

private:
    Eigen::Vector3i cell_of(const Vec3& point) const;
    std::size_t index_of(const Eigen::Vector3i& cell) const;

    const mesh::VolumeMesh& mesh_;
    std::vector<mesh::Box> boxes_;  // of the elements
    Vec3 min_;
    double cell_size_;
    Eigen::Vector3i cells_;
    std::vector<int> start_;     // of each cell in elements_
    std::vector<int> elements_;  // by cell, ascending
};

}  // namespace palpate::fem
