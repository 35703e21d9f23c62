#pragma once

#include <memory>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// The nearest point of a surface to some point.
struct SurfacePoint {
    int triangle = -1;
    Vec3 barycentric = Vec3::Zero();
    Vec3 position = Vec3::Zero();  // [mm]
    double distance = 0.0;         // [mm], not negative
};

/// Answers distance queries on a surface, by CGAL's tree of boxes. Queries are safe from several threads.
class SurfaceTree {
public:
    explicit SurfaceTree(const Surface& surface);
    ~SurfaceTree();
    SurfaceTree(SurfaceTree&&) noexcept;
    SurfaceTree& operator=(SurfaceTree&&) noexcept;

    SurfacePoint closest(const Vec3& point) const;

    /// Inside the closed surface or on it, by counting the crossings of rays. @pre the surface is closed.
    bool inside(const Vec3& point) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::mesh
