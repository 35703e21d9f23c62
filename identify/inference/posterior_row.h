#pragma once

#include <string>

namespace palpate::identify {

/// A row of posterior.csv. A parameter that stands for several links tells their geometric mean stiffness.
struct PosteriorRow {
    std::string parameter;  // "elongation", "flexion:zone2", "torsion:link17"
    int link = -1;          // -1: stands for several
    std::string unit;
    double mean = 0, sd = 0, q025 = 0, q50 = 0, q975 = 0;
    double prior_mean = 0, prior_sd = 0;
    bool informed = false;  // sd <= 0.7 prior_sd
};

}  // namespace palpate::identify
