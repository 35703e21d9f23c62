#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// Where a rigid tool touches the body.
struct ToolPrint {
    std::size_t motion = 0;  // among those of the action
    mesh::Contact contact;   // at rest the middle of what it touches of the skin, with a radius that gives it the same
                             // area, and the force of the tool on the body
    double stroke = 0;       // how far it has moved the skin since it came in touch, along its force [mm]
};

/// A print for each tool that touches the body in an action of a solution. A grip has none, as it holds material.
std::vector<ToolPrint> tool_prints(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                                   const ForwardSolution& forward, int k);

}  // namespace palpate::identify
