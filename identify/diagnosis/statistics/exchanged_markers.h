#pragma once

#include <utility>
#include <vector>

#include "identify/diagnosis/likelihood/whitening.h"
#include "identify/diagnosis/problem.h"

namespace palpate::identify {

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
