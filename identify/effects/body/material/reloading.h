#pragma once

#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// Does a body bear something less, or something else, after more? Only then does it show what a strain has left of its
/// stiffness; loads that grow in one place, or are borne each by a body of its own, find it as new.
bool bears_less_after_more(const Problem& problem);

}  // namespace palpate::identify
