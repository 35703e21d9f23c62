#include "pipeline/output/text/words.h"

#include <algorithm>
#include <cmath>

#include "fem/large_deformation/material_law_names.h"
#include "mesh/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

double number_or_nothing(const json& object, const char* key) {
    const json value = object.value(key, json());
    return value.is_number() ? value.get<double>() : 0;
}

std::string modulus_in_words(double young, double sd) {
    return sd < young ? fmt::format("E = {} MPa", mesh::with_sd(young, sd))
                      : fmt::format("E = {:.2g} MPa, hardly known (± {:.1g})", young, sd);
}

std::string poisson_in_words(const json& material) {
    const double ratio = material["poisson"].get<double>(), sd = number_or_nothing(material, "poisson_sd");
    if (material.value("poisson_declared", false)) return fmt::format("ν = {:.3g} (declared)", ratio);
    constexpr double incompressible = 0.499;  // beyond it nothing that is measured changes
    const double least = ratio - 2 * sd;
    constexpr double unknown = 0.125;  // 2 sd to either side are all that solids have, 0 to 0.5
    if (ratio > incompressible) return fmt::format("ν above {:.3f}", std::min(least, incompressible));
    if (sd > unknown) return fmt::format("ν hardly known ({})", mesh::with_sd(ratio, sd));
    return "ν = " + mesh::with_sd(ratio, sd);
}

}  // namespace

std::string if_it_explains_nothing(const json& relative) {
    if (!relative.is_number() || !(relative.get<double>() > 1)) return {};
    return " That is more than the markers moved: the model explains nothing. Check where the body is held, the units, "
           "the sign of the forces, and that body, markers and forces are in one frame.";
}

std::string place(const json& at) {
    constexpr double round_off = 1e-9;  // mm, N: of what is computed from numbers of a hundred
    const auto component = [&](std::size_t axis) {
        const double value = at[axis].get<double>();
        return std::abs(value) < round_off ? 0 : value;
    };
    return fmt::format("({:.3g}, {:.3g}, {:.3g})", component(0), component(1), component(2));
}

std::string in_sigmas(const json& whitened_rms) {
    if (!whitened_rms.is_number()) return "an unknown multiple of the noise";
    constexpr double adequate = 1.1;  // as a diagnosis takes it
    const double times = whitened_rms.get<double>();
    return times <= adequate ? "no more than noise and unknown contacts explain"
                             : fmt::format("{:.2g} times what noise and unknown contacts explain", times);
}

std::string region_in_words(const json& region) {
    const double young = region["young_mpa"].get<double>();
    return region["sd"].is_number() ? modulus_in_words(young, region["sd"].get<double>())
                                    : fmt::format("E = {:.3g} MPa (declared)", young);
}

std::string material_in_words(const json& material) {
    if (!material["young_mpa"].is_number()) return {};
    const double young = material["young_mpa"].get<double>(), sd = number_or_nothing(material, "young_sd_mpa");
    std::string text = modulus_in_words(young, sd);
    if (material["poisson"].is_number()) text += ", " + poisson_in_words(material);
    for (const json& region : material.value("regions", json::array()))
        text += fmt::format("; {}: {}", region["name"].get<std::string>(), region_in_words(region));
    return text;
}

std::string and_under_load(const json& load_exponent) {
    const std::string words = load_exponent["words"];
    return words == "the error is there without any load" ? " over all states; the error is present even without load"
                                                          : ", and " + words;
}

std::string law_in_words(const std::string& law) {
    const auto of_material = fem::material_law(law);
    return (of_material ? std::string(fem::name_in_prose(*of_material)) : law) + " law";
}

std::string probability_in_words(double probability) {
    constexpr double reported = 0.01;  // two digits behind the point are told
    if (probability < reported) return "below 0.01";
    if (probability > 1 - reported) return "above 0.99";
    return fmt::format("{:.2f}", probability);
}

std::string listed(const std::vector<std::string>& names) {
    std::vector<std::string> different;
    for (auto name = names.begin(); name != names.end(); ++name) {
        if (std::find(names.begin(), name, *name) != name) continue;
        const auto count = std::ranges::count(names, *name);
        different.push_back(count == 1 ? *name : fmt::format("{} ({})", *name, count));
    }
    std::string text;
    for (std::size_t i = 0; i < different.size(); ++i)
        text += (i == 0 ? "" : i + 1 == different.size() ? " and " : ", ") + different[i];
    return text;
}

std::string with_aside(std::string sentence, const std::string& aside) {
    std::size_t at = sentence.find(": ");
    if (at == std::string::npos) at = sentence.ends_with('.') ? sentence.size() - 1 : sentence.size();
    return sentence.insert(at, " (" + aside + ")");
}

}  // namespace palpate::pipeline
