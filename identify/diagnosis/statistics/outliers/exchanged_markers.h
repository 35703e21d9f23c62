#pragma once

#include <array>
#include <utility>
#include <vector>

#include "identify/diagnosis/likelihood/whitening.h"
#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// Median length of a vector of c independent normal numbers of sd 1, c from 0 to 3: the chi distribution's.
inline constexpr std::array<double, 4> chi_median{0, 0.6745, 1.1774, 1.5382};
/// So many times as large as readings usually are, an error is off by itself: three normal numbers are as large once in
/// 60,000. [chi distribution]
inline constexpr double rough_reading = 5;

/// Two markers whose labels are exchanged in one state.
struct ExchangedMarkers {
    int state = 0;                    // of the set
    std::pair<int, int> markers;      // as the set orders them
    std::pair<int, int> readings;     // of the problem
    double log_likelihood_ratio = 0;  // of the exchange, against the labels as they are told
};

/// Pairs of markers, each with three coordinates, that fit a state far better with their labels exchanged: more likely
/// than by chance among all pairs of all states, and left with errors as its other readings have. `d` (N): errors of a
/// fit, in sigmas; V: of noise and all that is unknown, the numbers of the fit among it, which few readings bend to a
/// wrong label. The likeliest first, each reading once.
std::vector<ExchangedMarkers> find_exchanged_markers(const Problem& problem, const Whitening& V,
                                                     const Eigen::VectorXd& d);

}  // namespace palpate::identify
