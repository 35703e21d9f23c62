#include "pipeline/forge/drafts/told.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/io/words.h"

namespace palpate::pipeline {
namespace {

/// Five digits: what is drawn might as well be short.
double rounded(double value) {
    return mesh::parse_number(fmt::format("{:.5g}", value)).value_or(value) + 0.0;  // which makes -0 a 0
}

}  // namespace

bool Told::has(const std::string& name) const {
    return std::ranges::find(wish_.given, name, &skeleton::EffectParameter::name) != wish_.given.end();
}

bool Told::has_any(const std::vector<std::string>& names) const {
    return std::ranges::any_of(names, [&](const std::string& name) { return has(name); });
}

double Told::value(const std::string& name, double drawn) const {
    const auto told = std::ranges::find(wish_.given, name, &skeleton::EffectParameter::name);
    return told == wish_.given.end() ? drawn : told->value;
}

Vec3 Told::vector(const std::array<std::string, 3>& names, const Vec3& drawn) const {
    if (!has_any({names.begin(), names.end()})) return drawn;
    return {value(names[0], 0), value(names[1], 0), value(names[2], 0)};
}

skeleton::Effect Told::effect(const std::vector<std::pair<std::string, double>>& drawn) const {
    skeleton::Effect effect{wish_.effect, {}};
    for (const skeleton::KnownParameter& known : known_) {
        const auto own = std::ranges::find(drawn, known.name, &std::pair<std::string, double>::first);
        if (has(known.name)) {
            effect.parameters.push_back({known.name, value(known.name, 0), known.unit});
        } else if (own != drawn.end()) {
            effect.parameters.push_back({known.name, rounded(own->second), known.unit});
        }
    }
    return effect;
}

}  // namespace palpate::pipeline
