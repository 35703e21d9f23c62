#pragma once

#include <string>

#include "pipeline/play/play_data.h"

namespace palpate::pipeline {

/// One self-contained page that needs no network: the models, the runtime as a module, and the view.
std::string play_page(const PlayData& data);

}  // namespace palpate::pipeline
