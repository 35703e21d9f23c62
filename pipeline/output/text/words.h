#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// "12.3 %"
inline std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

/// What follows an error larger than what there is to explain; else nothing.
inline std::string if_it_explains_nothing(const nlohmann::json& relative) {
    if (!relative.is_number() || !(relative.get<double>() > 1)) return {};
    return " That is more than the markers moved: the model explains nothing. Check where the body is held, the units, "
           "the sign of the forces, and that body, markers and forces are in one frame.";
}

/// A place or a direction out of three numbers: "(80, 20, 0)".
inline std::string place(const nlohmann::json& at) {
    return fmt::format("({:.3g}, {:.3g}, {:.3g})", at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
}

/// How much an error is, against what noise and unknown contacts explain.
inline std::string in_sigmas(const nlohmann::json& whitened_rms) {
    if (!whitened_rms.is_number()) return "an unknown multiple of the noise";
    return fmt::format("{:.3g} times what noise and unknown contacts explain", whitened_rms.get<double>());
}

/// "gravity, misalignment and outliers"
inline std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    }
    return text;
}

/// Puts an aside before a sentence's colon, or before its full stop: "Gravity is missing (p = 1): 9.8 m/s^2."
inline std::string with_aside(std::string sentence, const std::string& aside) {
    std::size_t at = sentence.find(": ");
    if (at == std::string::npos) at = sentence.ends_with('.') ? sentence.size() - 1 : sentence.size();
    return sentence.insert(at, " (" + aside + ")");
}

}  // namespace palpate::pipeline
