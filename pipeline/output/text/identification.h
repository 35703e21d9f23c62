#pragma once

#include <string>

#include "identify/inference/identify_result.h"

namespace palpate::pipeline {

/// One page for the terminal: what was identified from what, how the fit and the particles went, the parameters.
std::string identification_in_words(const identify::IdentifyResult& found);

}  // namespace palpate::pipeline
