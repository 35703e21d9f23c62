#pragma once

namespace palpate::fem {

/// How an element keeps its volume.
enum class Dilatation {
    full,  // the displacement's own divergence
    mean,  // P2/P0: the divergence is replaced by its mean over the element, which does not lock near nu = 0.5
};

}  // namespace palpate::fem
