#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "skeleton/model.h"

namespace palpate::pipeline {

/// Words for each effect of a body that another program's file does not hold; `held`: those that it does.
inline std::vector<std::string> effects_left_out(const skeleton::Model& model, const std::vector<std::string>& held) {
    std::vector<std::string> words;
    for (const skeleton::Effect& effect : model.effects) {
        if (!skeleton::is_body_effect(effect.name) || std::ranges::find(held, effect.name) != held.end()) continue;
        words.push_back("effect '" + effect.name + "' is left out");
    }
    return words;
}

}  // namespace palpate::pipeline
