#pragma once

#include <vector>

#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// States in which the same acted: what they differ by is noise, or a memory of the body.
struct Repeat {
    std::vector<int> states;  // of the set
    bool loaded = false;
    bool held = false;    // one probe's, at several times: creep differs, too
    double sd_mm = 0;     // of a coordinate that was read in one of them: noise as the repeats tell it [mm]
    double sigma_mm = 0;  // as it is stated, or assumed [mm]
    int freedoms = 0;     // coordinates read more than once, less their means
};

/// Groups of two and more, in the order of their first state: loads within 2 % of each other, at the same places.
/// `error_mm` (N): readings less what a linear body answers to the loads as they were, so that small differences of the
/// loads drop out.
std::vector<Repeat> repeated_states(const Problem& problem, const Eigen::VectorXd& error_mm);

}  // namespace palpate::identify
