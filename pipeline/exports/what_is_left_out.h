#pragma once

#include <functional>
#include <string>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// Words for each effect of a body that another program's file does not hold; `holds`: does it hold that one?
inline std::vector<std::string> omitted_effects(const skeleton::Model& model,
                                                const std::function<bool(const skeleton::EffectRecord&)>& holds) {
    std::vector<std::string> words;
    for (const skeleton::EffectRecord& effect : model.effects) {
        if (!skeleton::is_body_effect(effect.name) || holds(effect)) continue;
        words.push_back("effect '" + effect.name + "' is left out");
    }
    return words;
}

}  // namespace palpate::pipeline
