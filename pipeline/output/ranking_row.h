#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// The row of an effect in the "ranking" of a diagnosis.json; nullptr: it has none. An effect that is there several
/// times, as two inclusions, has as many rows. @param which of them
inline const nlohmann::json* ranking_row(const nlohmann::json& diagnosis, const std::string& effect,
                                         std::ptrdiff_t which = 0) {
    if (diagnosis.is_null()) return nullptr;
    for (const nlohmann::json& row : diagnosis["ranking"])
        if (row["effect"] == effect && which-- == 0) return &row;
    return nullptr;
}

/// The row of an effect of a model. @param effect one of `effects`
inline const nlohmann::json* ranking_row(const nlohmann::json& diagnosis,
                                         const std::vector<skeleton::EffectRecord>& effects,
                                         const skeleton::EffectRecord& effect) {
    const auto before = [&](const skeleton::EffectRecord& one) { return &one < &effect && one.name == effect.name; };
    return ranking_row(diagnosis, effect.name, std::ranges::count_if(effects, before));
}

}  // namespace palpate::pipeline
