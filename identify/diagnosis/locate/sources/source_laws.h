#pragma once

#include <utility>
#include <vector>

#include "identify/diagnosis/locate/missing_source.h"
#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// How large the load of a state is, of 1 at most: of contacts, else of what is moved or set.
Eigen::VectorXd relative_loads(const Problem& problem);  // (S)

/// How many states are read.
int read_states(const Problem& problem);
/// States in which a source shows that alters the readings by so much, in sigmas (N): by a fifth or more of the most,
/// rms.
std::vector<int> states_shown(const Problem& problem, const Eigen::VectorXd& altered);

/// Strengths of a source in each state (S), of 1 at most, under the laws that are alike at all places. Laws under which
/// the set's states are alike, or as under another, are left out.
std::vector<std::pair<SourceLaw, Eigen::VectorXd>> common_laws(const Problem& problem);

/// The same for each probe that loads the body: 1 in its states and 0 in others, with the probe's number.
std::vector<std::pair<int, Eigen::VectorXd>> probes_alone(const Problem& problem);

}  // namespace palpate::identify
