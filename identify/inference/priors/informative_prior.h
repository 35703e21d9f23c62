#pragma once

#include <string>
#include <vector>

namespace palpate::identify {

struct LogNormalPrior;
struct Parameters;

/// The prior of a stiffness from specimens of the same kind: its logarithm is normal, or ln(1 - 2 nu) of
/// "compressibility".
struct InformativePrior {
    std::string parameter;  // of the skeleton, as in posterior.csv; "young" and "compressibility" of finite elements
    double mean = 0, sd = 1;
};

/// Replaces the prior of each parameter by that from specimens where that is narrower: few specimens that differ much
/// inform a link less than its neighbours do. Returns the names of these parameters.
std::vector<std::string> inform(LogNormalPrior& prior, const Parameters& parameters,
                                const std::vector<InformativePrior>& from_specimens);

/// That of a parameter; null: specimens inform it no better than a standard deviation of `sd`.
const InformativePrior* prior_of(const std::string& parameter, double sd,
                                 const std::vector<InformativePrior>& from_specimens);

}  // namespace palpate::identify
