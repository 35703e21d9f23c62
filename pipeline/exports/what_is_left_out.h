#pragma once

#include <functional>
#include <string>
#include <vector>

#include "skeleton/model.h"

namespace palpate::pipeline {

/// Words for each effect of a body that another program's file does not hold; `holds`: does it hold that one?
inline std::vector<std::string> effects_left_out(const skeleton::Model& model,
                                                 const std::function<bool(const skeleton::Effect&)>& holds) {
    std::vector<std::string> words;
    for (const skeleton::Effect& effect : model.effects) {
        if (!skeleton::is_body_effect(effect.name) || holds(effect)) continue;
        words.push_back("effect '" + effect.name + "' is left out");
    }
    return words;
}

}  // namespace palpate::pipeline
