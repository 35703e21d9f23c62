#pragma once

#include "identify/inference/domains/position/position_domain.h"

namespace palpate::bench {

/// Log multipliers of least squared error, by other people's optimisers: Eigen's, with derivatives by differences, and
/// NLopt's CRS2, where it is installed.
Eigen::VectorXd levenberg_marquardt(const identify::PositionDomain& domain);
#ifdef PALPATE_WITH_NLOPT
Eigen::VectorXd controlled_random_search(const identify::PositionDomain& domain);
#endif

}  // namespace palpate::bench
