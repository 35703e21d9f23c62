#pragma once

#include <string>

#include "identify/recordings/assembly/clocks/signal.h"

namespace palpate::identify {

/// A quantity that rises or falls, as one file tells it.
struct CommonColumn {
    std::string file;
    Signal signal;  // without gaps, two samples at least
};

/// When the reference shows what another file shows: the reference's times over the other's. What stands still is
/// taken at its middle. @param name of the quantity, for messages
/// @throws InvalidInput where one side goes up and down, or both have no values in common.
Signal clock_by_common(const std::string& name, const CommonColumn& reference, const CommonColumn& other);

}  // namespace palpate::identify
