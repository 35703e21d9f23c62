#pragma once

#include <vector>

#include "pipeline/synthesis/loading/simulation.h"

namespace palpate::pipeline {

/// What the load cells of a history's tools read in a row, without noise. `q`: the body's configuration there.
std::vector<identify::ReactionReading> reactions_of(const Specimen& specimen, const TrueConditions& conditions,
                                                    const ProbeLoadHistory& history, std::size_t row,
                                                    const Eigen::VectorXd& q);

/// Forces of the tools, a row of the histories after the other (tools x 3) [N]; NaN where there is no path.
std::vector<Points> forces_of_tools(const Specimen& specimen, const TrueConditions& conditions,
                                    const std::vector<ProbeLoadHistory>& histories,
                                    const std::vector<EquilibriumPath>& paths);

}  // namespace palpate::pipeline
