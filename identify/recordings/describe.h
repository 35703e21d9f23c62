#pragma once

#include <string>

#include "identify/recordings/recording.h"

namespace palpate::identify {

/// A table of what a recording holds, to be read by people: points, frames, clock and rate, share of what is missing,
/// channels with unit and extremes, notes.
std::string describe(const Recording& recording);

}  // namespace palpate::identify
