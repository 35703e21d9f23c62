#pragma once

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// The steps of `repair_surface`, one idea a file. Each takes a welded surface and returns a better one; what it
/// cannot mend it leaves.

/// Drops twins and triangles with a repeated corner; then neighbours agree about the outside, sheets that meet in one
/// edge are taken apart, and borders that lie on each other are stitched.
Surface orient_and_stitch(const Surface& surface);

/// Fills holes whose box has a diagonal of `largest` [mm] or less.
Surface fill_holes(const Surface& surface, double largest);

/// Removes triangles without area (by flips) and cuts out those that cross, filling the gaps.
Surface remove_crossings(const Surface& surface);

/// The union of closed shells that overlap.
/// @throws SolverFailure where a shell is not closed or crosses itself.
Surface unite_shells(const Surface& surface);

/// A closed surface round everything, no closer than `offset`; it enters no hole narrower than `alpha` [mm].
Surface wrap(const Surface& surface, double alpha, double offset);

}  // namespace palpate::mesh
