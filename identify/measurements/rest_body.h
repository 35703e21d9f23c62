#pragma once

#include "identify/measurements/measurement_set.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::identify {

/// Where the body is at rest, for questions about places.
struct RestBody {
    explicit RestBody(const mesh::Surface& surface);

    mesh::SurfaceTree tree;
    mesh::Box box;
    bool is_closed = false;

    /// In its material or on its surface; of an open surface nobody knows what is inside: its box has to do.
    bool holds(const Vec3& point) const;
    /// How deep below the surface [mm]; 0 outside, and for an open surface.
    double depth(const Vec3& point) const;
};

/// "[1, 2, 3] mm", for a message.
std::string place_in_words(const Vec3& place);

}  // namespace palpate::identify
