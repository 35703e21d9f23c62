#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// What nobody can know about how tools are moved and cables drawn in: for each tool its play, and the compliance of
/// what moves it; for each tendon by length its slack, and what it gives way by.
struct ToolNuisances {
    std::vector<std::string> names;
    Signatures signatures;  // one column each: an error of the pose in every action, of the tool's largest motion
};

/// The motion falls short by the play, and by what machine and grip yield to the force that the tool feels, each the
/// same share of the largest motion (and force) in all actions; tendons likewise. Keeps references to the arguments.
ToolNuisances tool_nuisances(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                             const ForwardSolution& forward);

}  // namespace palpate::identify
