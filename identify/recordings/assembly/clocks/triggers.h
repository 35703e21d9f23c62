#pragma once

#include <optional>
#include <vector>

#include "identify/recordings/assembly/clocks/lag.h"

namespace palpate::identify {

/// When a signal crosses a level upward (or downward), between samples along a straight line. It has to come back by a
/// tenth of the signal's range before it can cross again: noise at the level is one edge. @param level none: halfway
/// between the least and the largest value.
std::vector<double> edges_of(const Signal& signal, bool rising, std::optional<double> level);

/// The clock that puts the times of the same edges on each other. Of one edge each: the offset; of more: rate and
/// offset by least squares. Where one side has seen more edges, those are paired that leave the least, if that is one
/// choice: none otherwise, and where a side has no edge.
/// @param interval, other_interval between samples [s], which bound how well an edge is known
std::optional<ClockFit> match_edges(const std::vector<double>& reference, const std::vector<double>& other,
                                    double interval, double other_interval);

}  // namespace palpate::identify
