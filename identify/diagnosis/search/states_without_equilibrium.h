#pragma once

#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// The problem without the probes that press harder than Young's modulus on a patch and find no equilibrium under the
/// model's last law: they say nothing. Each is told in `notes`.
/// @throws SolverFailure when no loaded action remains.
Problem without_crushing_probes(const BodyModel& model, const Problem& problem, int threads,
                                std::vector<std::string>& notes);

/// The problem without the states in which a tool stands where the model as it starts finds no equilibrium under its
/// last law. Each is told in `notes`. The problem as it is where it finds one in all or in none of them.
Problem without_unreached_tools(const BodyModel& model, const Problem& problem, int threads,
                                std::vector<std::string>& notes);

}  // namespace palpate::identify
