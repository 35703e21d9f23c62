#pragma once

#include <optional>

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// A solution in which states under tools are in that of their equilibria which is nearest to the measurement; none
/// where they are so already. A body off which a tool slips goes to one side or the other: which of them, the path
/// tells only in theory.
///
/// A state whose markers are far off is sought again from the configuration that forces at the markers would bring to
/// where they were measured, by the stiffness at rest; what is found counts if it is much nearer. A unique equilibrium
/// is found once more, whatever the readings: nothing is fitted here. Bodies that remember stay on their path.
std::optional<ForwardSolution> nearer_to_measured(const BodyModel& model, const Problem& problem,
                                                  const Explanation& explanation, const ForwardSolution& forward,
                                                  int threads);

}  // namespace palpate::identify
