#include "pipeline/output/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/effects/body/material/stiffness_parts.h"
#include "identify/effects/catalogue.h"
#include "identify/effects/vector_words.h"
#include "pipeline/output/ranking_row.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

double number(const skeleton::EffectRecord& effect, const std::string& name) {
    const auto found = std::ranges::find(effect.parameters, name, &skeleton::EffectParameter::name);
    return found == effect.parameters.end() ? 0 : found->value;
}

bool has(const skeleton::EffectRecord& effect, const std::string& name) {
    return std::ranges::find(effect.parameters, name, &skeleton::EffectParameter::name) != effect.parameters.end();
}

json vector(const skeleton::EffectRecord& effect, const std::array<const char*, 3>& names) {
    return {number(effect, names[0]), number(effect, names[1]), number(effect, names[2])};
}

/// Takes out of a finding's vector the components that the readings do not determine, as its sentence does.
void set_undetermined_apart(json& found, const std::array<const char*, 3>& names, const json* candidate) {
    found["undetermined"] = json::array();
    if (!candidate) return;
    json& vector = found["vector"];
    const json& parameters = (*candidate)["parameters"];
    std::array<double, 3> sd{};
    for (std::size_t a = 0; a < 3; ++a) {
        if (!parameters.contains(names[a]) || !parameters[names[a]]["sd"].is_number()) return;
        sd[a] = parameters[names[a]]["sd"].get<double>();
    }
    const double least = *std::ranges::min_element(sd);
    for (std::size_t a = 0; a < 3; ++a) {
        double rest = 0;
        for (std::size_t b = 0; b < 3; ++b)
            if (b != a) rest = std::hypot(rest, vector[b].get<double>());
        if (rest > 0 && identify::is_undetermined({vector[a].get<double>(), sd[a], rest, least})) {
            json axis{0, 0, 0};
            axis[a] = 1;
            found["undetermined"].push_back({{"axis", axis}, {"value", vector[a]}, {"sd", sd[a]}});
            vector[a] = 0.0;
        }
    }
}

/// What the diagnosis says of it, else what it is.
std::string words_of(const skeleton::EffectRecord& effect, const json* candidate) {
    if (candidate && candidate->contains("sentence")) return (*candidate)["sentence"];
    const auto known = identify::effect_named(effect.name);
    return known && !effect.parameters.empty() ? known->sentence(effect) : effect.name;
}

/// The parts of a map of stiffness, as balls.
void add_parts(const skeleton::EffectRecord& effect, const std::string& words, json& findings) {
    const identify::StiffnessEstimate map(effect);
    const std::vector<identify::StiffnessPart> parts = map.parts();
    if (parts.empty()) findings.push_back({{"effect", effect.name}, {"words", words}, {"kind", "words"}});
    for (const identify::StiffnessPart& part : parts)  // the sentence is of all of them, and stands once
        findings.push_back(
            {{"effect", effect.name},
             {"words",
              &part == &parts.front() ? words : fmt::format("{:.2g} times the mean stiffness here.", part.ratio)},
             {"kind", "ball"},
             {"center", {part.centre.x(), part.centre.y(), part.centre.z()}},
             {"radius", map.length()},
             {"ratio", part.ratio}});
}

}  // namespace

json findings_json(const std::vector<skeleton::EffectRecord>& effects, const json& diagnosis) {
    constexpr std::array gravity{"gx", "gy", "gz"}, normal{"nx", "ny", "nz"}, centre{"cx", "cy", "cz"},
        force{"fx", "fy", "fz"};
    json findings = json::array();
    for (const skeleton::EffectRecord& effect : effects) {
        const json* candidate = ranking_row(diagnosis, effects, effect);
        if (effect.name == "map" && !effect.parameters.empty()) {
            add_parts(effect, words_of(effect, candidate), findings);
            continue;
        }
        json found{{"effect", effect.name}, {"words", words_of(effect, candidate)}, {"kind", "words"}};
        if (has(effect, gravity.front())) {
            found["kind"] = "arrow";
            found["vector"] = vector(effect, gravity);
            set_undetermined_apart(found, gravity, candidate);
        } else if (has(effect, centre.front())) {
            found["kind"] = "ball";
            found["center"] = vector(effect, centre);
            found["radius"] = number(effect, "radius");
            if (has(effect, force.front())) found["vector"] = vector(effect, force);
            if (has(effect, "ratio")) found["ratio"] = number(effect, "ratio");
        } else if (has(effect, normal.front())) {
            const bool is_plane = has(effect, "offset");
            found["kind"] = is_plane ? "plane" : "axis";
            found["vector"] = vector(effect, normal);
            if (is_plane) found["offset"] = number(effect, "offset");
        } else if (effect.name == "compliant-support") {
            found["kind"] = "springs";
        }
        findings.push_back(std::move(found));
    }
    // What no effect is named for.
    const json where = diagnosis.is_object() ? diagnosis.value("where", json()) : json();
    if (where.is_object() && diagnosis["explanation"].empty()) {
        findings.push_back({{"effect", ""},
                            {"words", where["sentence"]},
                            {"kind", "ball"},
                            {"center", where["at"]},
                            {"radius", where["spread_mm"]}});
    }
    return findings;
}

}  // namespace palpate::pipeline
