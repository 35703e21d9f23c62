#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

// A preflight, as its JSON states it, in words.

/// An effect counts as one that a set can show where it could be named in at least this share of the cases that its
/// prior expects (locations, directions) [-]: the set is then more likely to show it than not.
inline constexpr double sufficient_share = 0.5;

/// "It could name gravity and inclusion; ...": the first sentences of the page.
std::string preflight_lead(const nlohmann::json& preflight);

/// What the stiffness numbers would be known to, a sentence each.
std::vector<std::string> parameter_sentences(const nlohmann::json& preflight);

/// How strong an effect is: "4200 mm/s^2", "gain error 11 %", "up to 12 N/mm"; "–" where there is no one number.
std::string own_strength(const nlohmann::json& own, const std::string& effect);

/// Is an effect named at some strength that its prior does not rule out? Else how strong it had to be is not
/// reported.
bool is_within_reach(const nlohmann::json& effect);

/// From which strength on an effect is named: "1820 mm/s^2", or "0.59 of its prior" where it has no one number; "–"
/// where none is within reach.
std::string threshold_in_words(const nlohmann::json& effect);

/// The table that `palpate check` prints, and what comes after it.
std::string preflight_in_words(const nlohmann::json& preflight);

/// Why a set does not show an effect at its prior's strength; empty: it does.
std::string why_not_shown(const nlohmann::json& preflight, const std::string& effect);

}  // namespace palpate::pipeline
