#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// "12.3 %"
inline std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

/// What follows an error larger than what there is to explain; else nothing.
std::string if_it_explains_nothing(const nlohmann::json& relative);

/// A place or a direction out of three numbers: "(80, 20, 0)".
std::string place(const nlohmann::json& at);

/// How much an error is, against what noise and unknown contacts explain: "4.8 times what noise and unknown contacts
/// explain", or "no more than" that.
std::string in_sigmas(const nlohmann::json& whitened_rms);

/// The modulus of a region of a material of its own: "E = 1.2 ± 0.1 MPa".
std::string region_in_words(const nlohmann::json& region);

/// The modulus and ratio of a body in finite elements, as its JSON states them: "E = 0.242 ± 0.012 MPa, ν = 0.499
/// (declared)", then "; tumour: E = 1.2 ± 0.1 MPa" for each region.
std::string material_in_words(const nlohmann::json& material);

/// How an error depends on the load, after "the rms error is 2 mm": ", and it grows in proportion to the load".
std::string and_under_load(const nlohmann::json& load_exponent);

/// A law of the material or of the equilibrium in prose: "neo-Hookean law".
std::string law_in_words(const std::string& law);

/// A probability that is nearly 0 or 1 is reported as such: "below 0.01".
std::string probability_in_words(double probability);

/// "gravity, inclusion (2) and outliers": what is repeated stands once, with its count.
std::string listed(const std::vector<std::string>& names);

/// Puts an aside before a sentence's colon, or before its full stop: "Gravity is missing (p = 1): 9.8 m/s^2."
std::string with_aside(std::string sentence, const std::string& aside);

}  // namespace palpate::pipeline
