#pragma once

#include "identify/diagnose/refit.h"

namespace palpate::identify {

/// A fit of the same body to other states of its set.
struct Nearby {
    const Problem* problem;
    const Refit* fit;
};

/// The fit as a start in another problem: with its configurations, without what goes with its readings; none where the
/// fit has not seen all that acts there.
std::optional<Refit> start_at(const Nearby& near, const Problem& problem);

}  // namespace palpate::identify
