#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

// A preflight, as its JSON tells it, in words.

/// "It could name gravity and inclusion; ...": the first sentences of the page.
std::string preflight_lead(const nlohmann::json& preflight);

/// What the stiffness numbers would be known to, a sentence each.
std::vector<std::string> parameter_sentences(const nlohmann::json& preflight);

/// "4.2e+03 mm/s^2", "ratio 1.8", "up to 12 N/mm"; "–" where there is no one number.
std::string own_strength(const nlohmann::json& own);

/// Is an effect named at some strength that its prior does not rule out? Else how strong it had to be is no number to
/// tell.
bool is_within_reach(const nlohmann::json& effect);

/// The table that `palpate check` prints, and what comes after it.
std::string preflight_in_words(const nlohmann::json& preflight);

/// Why a set does not show an effect at its prior's strength; empty: it does.
std::string why_not_shown(const nlohmann::json& preflight, const std::string& effect);

}  // namespace palpate::pipeline
