#include "skeleton/effects/effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "mesh/errors.h"
#include "mesh/io/words.h"
#include "skeleton/effects/compliant_support.h"
#include "skeleton/effects/gravity.h"

namespace palpate::skeleton {

namespace {

using Potential = std::shared_ptr<const fem::PointPotential>;

enum class Range { any, positive };

struct KnownParameter {
    std::string name, unit;
    Range range = Range::any;
};

// An effect of the body: what it is told, and how it is made of these numbers, in this order.
struct KnownEffect {
    std::string name;
    std::vector<KnownParameter> parameters;
    std::function<Potential(const std::vector<double>&)> make;
};

const std::vector<KnownEffect>& body_effects() {
    static const std::vector<KnownEffect> effects{
        {"gravity",
         {{"gx", "mm/s^2"}, {"gy", "mm/s^2"}, {"gz", "mm/s^2"}},
         [](const auto& g) { return std::make_shared<Gravity>(Vec3(g[0], g[1], g[2])); }},
        {"compliant-support",
         {{"stiffness", "N/mm", Range::positive}},
         [](const auto& k) { return std::make_shared<CompliantSupport>(k[0]); }},
    };
    return effects;
}

const std::vector<std::string> measurement_effects{"misalignment", "force-gain", "outliers"};

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
    std::vector<std::string> names;
    names.reserve(all.size());
    for (const Named& one : all) names.push_back(one.name);
    return names;
}

const KnownEffect& find_effect(const std::string& name) {
    const auto& known = body_effects();
    const auto found = std::ranges::find(known, name, &KnownEffect::name);
    if (found != known.end()) return *found;
    if (!is_body_effect(name))
        throw InvalidInput(
            fmt::format("effect '{}' is about the measurement, not the body: no model can play it", name));
    std::vector<std::string> names = names_of(known);
    names.insert(names.end(), measurement_effects.begin(), measurement_effects.end());
    throw InvalidInput(fmt::format("effect {} is not known{}; known are {}", mesh::cited(name),
                                   mesh::suggestion(name, names), mesh::listed(names)));
}

double number_of(const Effect& effect, const KnownParameter& known) {
    const auto found = std::ranges::find(effect.parameters, known.name, &EffectParameter::name);
    if (found == effect.parameters.end())
        throw InvalidInput(
            fmt::format("effect '{}': the parameter '{}' [{}] is missing", effect.name, known.name, known.unit));
    if (!found->unit.empty() && found->unit != known.unit)
        throw InvalidInput(fmt::format("effect '{}': {} is in {}, but must be in '{}'", effect.name, known.name,
                                       mesh::cited(found->unit), known.unit));
    const double value = found->value;
    const bool positive = known.range == Range::positive;
    if (!std::isfinite(value) || (positive && !(value > 0)))
        throw InvalidInput(fmt::format("effect '{}': {} is {:.6g} {}, but must be {}", effect.name, known.name, value,
                                       known.unit, positive ? "above 0" : "a number"));
    return value;
}

}  // namespace

bool is_body_effect(const std::string& name) {
    return std::ranges::find(measurement_effects, name) == measurement_effects.end();
}

std::shared_ptr<const fem::PointPotential> make_potential(const Effect& effect) {
    const KnownEffect& known = find_effect(effect.name);
    const std::vector<std::string> names = names_of(known.parameters);
    for (const EffectParameter& parameter : effect.parameters)
        if (std::ranges::find(names, parameter.name) == names.end())
            throw InvalidInput(fmt::format("effect '{}': the parameter {} is not known{}; known are {}", effect.name,
                                           mesh::cited(parameter.name), mesh::suggestion(parameter.name, names),
                                           mesh::listed(names)));
    std::vector<double> numbers;
    for (const KnownParameter& parameter : known.parameters) numbers.push_back(number_of(effect, parameter));
    return known.make(numbers);
}

fem::Potentials potentials_of(const std::vector<Effect>& effects) {
    fem::Potentials potentials;
    for (const Effect& effect : effects)
        if (is_body_effect(effect.name)) potentials.push_back(make_potential(effect));
    return potentials;
}

}  // namespace palpate::skeleton
