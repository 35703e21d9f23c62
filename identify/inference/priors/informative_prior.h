#pragma once

#include <string>
#include <vector>

namespace palpate::identify {

struct LogNormalPrior;
struct Parameters;

/// What is believed of a stiffness before a set is read, from specimens of the same kind: normal is its logarithm, or
/// ln(1 - 2 nu) of "compressibility".
struct InformativePrior {
    std::string parameter;  // of the skeleton, as in posterior.csv; "young" and "compressibility" of finite elements
    double mean = 0, sd = 1;
};

/// Puts what specimens tell of some parameters in place of what a prior believes of them, where they tell more: few
/// that differ much say less of a link than its neighbours do. Returns the names of these parameters.
std::vector<std::string> inform(LogNormalPrior& prior, const Parameters& parameters,
                                const std::vector<InformativePrior>& from_specimens);

/// The one of a parameter of that name; null: specimens tell no more than a standard deviation of `sd`.
const InformativePrior* prior_of(const std::string& parameter, double sd,
                                 const std::vector<InformativePrior>& from_specimens);

}  // namespace palpate::identify
