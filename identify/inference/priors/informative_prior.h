#pragma once

#include <string>
#include <vector>

namespace palpate::identify {

/// The prior of a stiffness from specimens of the same kind: its logarithm is normal, or ln(1 - 2 nu) of
/// "compressibility".
struct InformativePrior {
    std::string parameter;  // of the skeleton, as in posterior.csv; "young" and "compressibility" of finite elements
    double mean = 0, sd = 1;
};

/// That of a parameter; null: specimens inform it no better than a standard deviation of `sd`.
const InformativePrior* prior_of(const std::string& parameter, double sd,
                                 const std::vector<InformativePrior>& from_specimens);

}  // namespace palpate::identify
