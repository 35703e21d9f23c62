#pragma once

#include <string>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// Sizes of a body that are read, in the unit of its file: products of volumes stay normal numbers, and nanometres
/// as well as kilometres fit in.
inline constexpr double least_size = 1e-12, largest_size = 1e12;

/// A body's size, as a share of its largest coordinate, below which rounding of the coordinates (2^-53 of them) is no
/// longer small against the distance within which corners are welded (1e-6 of the diagonal).
inline constexpr double least_share_of_coordinate = 1e-7;

/// Coordinates below this share of the diagonal are rounding errors of an exporter. Exact arithmetic would spend
/// thousands of digits on them.
inline constexpr double negligible_coordinate = 1e-30;

/// @param name of the file or the step, to begin messages with
/// @throws InvalidInput unless the points span a size, of `least_size` to `largest_size`, that is not lost against
/// their coordinates.
void require_usable_size(const Points& points, const std::string& name);

/// Only the vertices that a triangle names, in their order; negligible coordinates are 0.
/// @param unused when asked for: how many were left out
/// @throws InvalidInput where there is no triangle, a triangle names a vertex that does not exist, a vertex in use is
/// not finite, or the size is not usable.
Surface well_formed(const Surface& surface, const std::string& name, int* unused = nullptr);

}  // namespace palpate::mesh
