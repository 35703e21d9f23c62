#pragma once

#include <optional>

namespace palpate::identify {

/// When a recording stands still.
struct PlateauOptions {
    double shortest = 0;  // [s]; 0: ten frames, 0.3 s at least, a fifth of the recording at most
    // What changes by less over the shortest plateau stands still, as a share of the range. 5 %: a body that creeps
    // keeps creeping for hours, by less each time as long; what loads it does so within a blink. What is left stands in
    // sigma.
    double still = 0.05;
    std::optional<double> within = {};  // the same as a change of the first group [its unit], in place of the share

    /// @throws InvalidInput naming what is out of its range
    void validate() const;
};

}  // namespace palpate::identify
