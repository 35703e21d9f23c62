#pragma once

#include <string>
#include <vector>

#include "mesh/core/surface.h"

namespace palpate::pipeline {

/// Which pieces of a surface are the body, where it has several that do not touch.
enum class KeptPieces {
    automatic,  // all but crumbs of a thousandth of the largest; two that count are refused
    largest,
    all,
};

/// A surface without the pieces that are not the body.
struct KeptSurface {
    mesh::Surface surface;
    std::vector<std::string> notes;  // what was left out, in words
    std::string refusal = {};        // why the pieces that are left are no body; empty: they are one
};

/// Pieces are parts, or parts together, whose boxes are apart: what lies within another, or crosses it, is of it.
KeptSurface keep_pieces(const mesh::Surface& surface, KeptPieces kept);

/// Why a surface cannot be one of a body, in words: it is flat; empty: nothing speaks against it.
std::string refusal_of_flat(const mesh::Surface& surface);

}  // namespace palpate::pipeline
