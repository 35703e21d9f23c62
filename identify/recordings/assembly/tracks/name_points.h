#pragma once

#include <string>
#include <vector>

#include "identify/recordings/recording.h"
#include "mesh/types.h"

namespace palpate::identify {

/// Which of some seen points is which of the wanted ones.
struct PointNames {
    std::vector<int> seen_of;  // for each wanted point the seen one, or -1
    double misfit = 0;         // rms of what distances to near points differ by, as a share of these
    double second = 0;         // the same of the best other choice; infinity where there is none
    bool is_clear = false;     // whether the choice stands out
};

/// By their distances from each other, which no rigid motion alters and a bending one little between neighbours: of all
/// ways to choose, the one with the least sum over pairs of ((d - D) / D)^2 (D_min / D)^2, near pairs before far ones.
/// Sought to the end, branch by branch, where that is less work than a second; the choice is clear if each other one
/// leaves half as much again at least. @param seen, wanted (n x 3); rows of NaN are not there
PointNames name_points(const Points& seen, const Points& wanted);

}  // namespace palpate::identify
