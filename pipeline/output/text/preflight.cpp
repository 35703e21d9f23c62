#include "pipeline/output/text/preflight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::vector<std::string> effects_that(const json& preflight, const char* can_be_named) {
    std::vector<std::string> names;
    for (const json& one : preflight["effects"])
        if (one["can_be_named"] == can_be_named) names.push_back(one["effect"]);
    return names;
}

std::string cell(const json& value) {
    constexpr double large = 100;  // two digits suffice, without a power of ten
    if (!value.is_number()) return "–";
    return fmt::format(fmt::runtime(value.get<double>() < large ? "{:.2g}" : "{:.0f}"), value.get<double>());
}

constexpr std::size_t most_listed = 6;  // lines of a kind; the page and the JSON have all

constexpr std::size_t most_next = 3;  // likewise, of what to do next

/// To three digits, without powers of ten as far as people write numbers so.
std::string in_digits(double value) {
    constexpr double large = 1e3, most = 1e6;  // {:.3g} has a power of ten from 1e3 on; so have people from 1e6
    // a ratio that is nearly 1 needs more
    if (std::abs(value - 1) < 0.1) return fmt::format("{:.4g}", value);
    if (std::abs(value) < large || std::abs(value) >= most) return fmt::format("{:.3g}", value);
    const double step = std::pow(10, std::floor(std::log10(std::abs(value))) - 2);
    return fmt::format("{:.0f}", std::round(value / step) * step);
}

/// Three, or as many as it takes to tell two numbers apart.
int digits_apart(double low, double high) {
    constexpr int most = 6;  // numbers that agree in so many are told as equal
    int digits = 3;
    while (digits < most && fmt::format("{:.{}g}", low, digits) == fmt::format("{:.{}g}", high, digits)) ++digits;
    return digits;
}

/// Effects that an experiment makes easier to name.
std::vector<std::string> eased_by(const json& experiment) {
    std::vector<std::string> names;
    for (const json& gain : experiment["gains"]) names.push_back(gain["effect"]);
    return names;
}

}  // namespace

std::string own_strength(const json& own, const std::string& effect) {
    if (own.is_null()) return "–";
    const double value = own["value"].get<double>();
    const std::string bound = own["at_most"].get<bool>() ? "up to " : "";
    if (own["unit"] != "1") return bound + in_digits(value) + " " + own["unit"].get<std::string>();
    // A bare number says what it is of: a share in per cent, else a ratio.
    static const std::map<std::string, std::pair<const char*, double>> meanings{
        {"force-gain", {"gain error {} %", 100}}, {"actuation-gain", {"gain error {} %", 100}},
        {"slip", {"motion error {} %", 100}},     {"swelling", {"{} % growth", 100}},
        {"viscosity", {"{} % creep", 100}},       {"damage", {"{} % softer", 100}},
        {"prestress", {"{} x shear modulus", 1}}, {"anisotropy", {"{} x shear modulus", 1}},
        {"volume", {"ratio off by {}", 1}},       {"friction", {"coefficient {}", 1}}};
    const auto found = meanings.find(effect);
    if (found == meanings.end()) return bound + own["name"].get<std::string>() + " " + in_digits(value);
    const auto& [words, scale] = found->second;
    return bound + fmt::format(fmt::runtime(words), cell(scale * value));
}

bool is_within_reach(const json& effect) {
    constexpr double most = 5;  // times the prior's strength: beyond it the linearisation is not valid
    const json& least = effect["least"]["of_prior"];
    return least.is_number() && least.get<double>() <= most;
}

std::string threshold_in_words(const json& effect) {
    const json& least = effect["least"];
    if (!is_within_reach(effect)) return "–";
    return least["own"].is_null() ? fmt::format("{:.2g} of its prior", least["of_prior"].get<double>())
                                  : own_strength(least["own"], effect["effect"]);
}

std::string preflight_lead(const json& preflight) {
    std::vector<std::string> could = effects_that(preflight, "yes");
    std::ranges::copy(effects_that(preflight, "mostly"), std::back_inserter(could));
    const std::vector<std::string> partly = effects_that(preflight, "partly");
    std::string words =
        could.empty()
            ? "No effect of the catalogue could be named from this set at the strength that its prior expects."
            : fmt::format("Effects as strong as their priors expect could be named from this set: {}.", listed(could));
    if (!partly.empty()) words += fmt::format(" In some places or directions only: {}.", listed(partly));
    const std::size_t odd = preflight["suspicions"].size();
    words += odd == 0   ? " No reading looks off."
             : odd == 1 ? " One reading or marker looks off."
                        : fmt::format(" {} readings or markers look off.", odd);
    if (!preflight["experiments"].empty())
        words += " Next in the lab: " + preflight["experiments"][0]["words"].get<std::string>() + ".";
    return words;
}

std::vector<std::string> parameter_sentences(const json& preflight) {
    std::vector<std::string> result;
    const bool tells_a_force = preflight["tells_a_force"].get<bool>();
    for (const json& one : preflight["parameters"]) {
        const std::string name = one["name"];
        const std::string what = name == "young" ? "Young's modulus" : name == "poisson" ? "Poisson's ratio" : name;
        const std::string unit = one["unit"] == "1" ? "" : " " + one["unit"].get<std::string>();
        const double low = one["q025"], high = one["q975"];
        if (name == "young" && !tells_a_force) {
            result.push_back(
                "Without a measured force Young's modulus stays as it is assumed; ratios of stiffness can be "
                "identified.");
        } else if (one["informed"].get<bool>()) {
            const int digits = digits_apart(low, high);
            result.push_back(fmt::format("{} would lie between {:.{}g} and {:.{}g}{} (95 %).", what, low, digits, high,
                                         digits, unit));
        } else if (one["narrows_prior_to"].get<double>() > 0.99 &&
                   high - low < 0.02 * std::abs(one["value"].get<double>())) {
            result.push_back(fmt::format("{} is the set's own, {:.3g}{}.", what, one["value"].get<double>(), unit));
        } else {
            result.push_back(fmt::format("{} is poorly determined by these readings: {:.3g} to {:.3g}{} (95 %).", what,
                                         low, high, unit));
        }
    }
    if (preflight["guess"]["law"] == "linear")
        result.emplace_back(
            "No equilibrium was found in large deformation: all is judged in small strain, and strengths are orders of "
            "magnitude where the body moves far.");
    const json& parts = preflight["parts"];
    const auto informed = std::ranges::count_if(parts, [](const json& part) { return part["informed"].get<bool>(); });
    result.push_back(informed == 0 ? "No single part's stiffness could be determined separately."
                                   : fmt::format("Of {} parts of the body, the stiffness of {} could be determined "
                                                 "separately.",
                                                 parts.size(), informed));
    return result;
}

std::string preflight_in_words(const json& preflight) {
    std::string text =
        fmt::format("Before any fit, at E = {:.3g} MPa ({}):\n", preflight["guess"]["young_mpa"].get<double>(),
                    preflight["guess"]["from"] == "set" ? "the set's" : "at which it moves as far as was measured");
    for (const std::string& sentence : parameter_sentences(preflight)) text += "  " + sentence + "\n";
    text += fmt::format("  {:<18} {:>7} {:>22} {:>9} {:>8}  {}\n", "effect", "named", "from", "mm rms", "sigma", "");
    for (const json& one : preflight["effects"]) {
        const json& least = one["least"];
        const bool is_reached = is_within_reach(one);
        text += fmt::format("  {:<18} {:>7} {:>22} {:>9} {:>8}  {}\n", one["effect"].get<std::string>(),
                            one["can_be_named"].get<std::string>(), threshold_in_words(one),
                            is_reached ? cell(least["rms_mm"]) : "–", is_reached ? cell(least["rms_sigma"]) : "–",
                            one["why_not"].get<std::string>());
    }
    std::size_t listed_ones = 0;
    for (const json& one : preflight["suspicions"]) {
        if (++listed_ones > most_listed) break;
        text += "  - " + one["words"].get<std::string>() + "\n";
    }
    if (preflight["suspicions"].size() > most_listed)
        text += fmt::format("  - and {} more\n", preflight["suspicions"].size() - most_listed);
    listed_ones = 0;
    for (const json& one : preflight["repeats"]) {
        if (++listed_ones > most_listed) break;
        text += "  " + one["words"].get<std::string>() + "\n";
    }
    listed_ones = 0;
    for (const json& one : preflight["experiments"]) {
        if (++listed_ones > most_next) break;
        const auto opens = one["opens"].get<std::vector<std::string>>();
        text += "  Next in the lab: " + one["words"].get<std::string>() +
                (opens.empty() ? fmt::format(": it would make {} easier to identify.\n", listed(eased_by(one)))
                               : fmt::format(": it would show {}.\n", listed(opens)));
    }
    return text;
}

std::string why_not_shown(const json& preflight, const std::string& effect) {
    const auto found =
        std::ranges::find_if(preflight["effects"], [&](const json& one) { return one["effect"] == effect; });
    if (found == preflight["effects"].end()) return fmt::format("The set was not asked for {}.", effect);
    const json& one = *found;
    if (one["why_not"] == "" && one["share"].get<double>() >= sufficient_share) return {};
    const json& prior = one["prior"]["own"];
    return fmt::format("The set cannot show {}{}: {}.", effect,
                       prior.is_null() ? " at the strength of its prior"
                                       : fmt::format(" at the strength of its prior, {}", own_strength(prior, effect)),
                       one["why_not"].get<std::string>());
}

}  // namespace palpate::pipeline
