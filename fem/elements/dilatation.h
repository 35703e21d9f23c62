#pragma once

namespace palpate::fem {

/// How an element keeps its volume.
enum class Dilatation {
    full,  // the displacement's own divergence
    mean,  // P2/P0: the divergence is replaced by its mean over the element, which does not lock near nu = 0.5
    thin,  // its own as far as that does not lock, and the mean: for one element in the thickness of a plate, in large
           // deformation (ElementModel::local_bulk)
};

}  // namespace palpate::fem
