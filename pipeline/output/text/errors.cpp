#include "pipeline/output/text/errors.h"

#include <fmt/format.h>

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr ErrorKeys of_positions{"mm", "rms_mm", "held_out_rms_mm"};
constexpr ErrorKeys of_forces{"N", "reactions_rms_n", "held_out_reactions_rms_n"};

bool tells_forces(const json& error) { return error.value(of_forces.fitted, json()).is_number(); }

/// No error of positions is 0 but that of none.
bool tells_positions(const json& error) {
    const json rms = error.value(of_positions.fitted, json());
    return !tells_forces(error) || (rms.is_number() && rms.get<double>() > 0);
}

std::string in_words(const json& error, const char* millimetres, const char* newtons) {
    std::string text;
    const auto add = [&](const char* key, const char* unit) {
        const json rms = error.value(key, json());
        if (rms.is_number()) text += fmt::format("{}{:.3g} {}", text.empty() ? "" : " and ", rms.get<double>(), unit);
    };
    if (tells_positions(error)) add(millimetres, of_positions.unit);
    if (tells_forces(error)) add(newtons, of_forces.unit);
    return text;
}

}  // namespace

ErrorKeys keys_of(const json& error) { return tells_positions(error) ? of_positions : of_forces; }

std::string rms_in_words(const json& error) { return in_words(error, of_positions.fitted, of_forces.fitted); }

std::string held_out_rms_in_words(const json& error) {
    return in_words(error, of_positions.held_out, of_forces.held_out);
}

}  // namespace palpate::pipeline
