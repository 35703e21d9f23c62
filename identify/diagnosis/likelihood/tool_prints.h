#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// Where rigid tools touch the body in an action of a solution, a contact for each that does: at rest the middle of
/// what it touches of the skin, with a radius that gives it the same area, and the force of the tool on the body. A
/// grip has none, as it holds material.
std::vector<mesh::Contact> tool_prints(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                                       const ForwardSolution& forward, int k);

}  // namespace palpate::identify
