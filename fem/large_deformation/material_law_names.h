#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fem/large_deformation/material_law.h"

namespace palpate::fem {

struct MaterialLawName {
    MaterialLaw law;
    const char* in_files;  // in settings, and in what is written
    const char* in_prose;
};

/// All laws, in the order of their numbers.
inline constexpr std::array<MaterialLawName, 3> material_law_names{
    {{MaterialLaw::linear, "linear", "linear"},
     {MaterialLaw::svk, "svk", "St Venant-Kirchhoff"},
     {MaterialLaw::neo_hookean, "neo-hooke", "neo-Hookean"}}};

inline const char* name_in_files(MaterialLaw law) { return material_law_names[static_cast<std::size_t>(law)].in_files; }

inline const char* name_in_prose(MaterialLaw law) { return material_law_names[static_cast<std::size_t>(law)].in_prose; }

/// That of the name in files; empty where there is none.
inline std::optional<MaterialLaw> material_law(std::string_view name) {
    const auto* found = std::ranges::find(material_law_names, name, &MaterialLawName::in_files);
    return found == material_law_names.end() ? std::nullopt : std::optional(found->law);
}

/// Names in files, by the laws' numbers.
inline std::vector<std::string> material_law_choices() {
    std::vector<std::string> names;
    names.reserve(material_law_names.size());
    for (const MaterialLawName& each : material_law_names) names.emplace_back(each.in_files);
    return names;
}

}  // namespace palpate::fem
