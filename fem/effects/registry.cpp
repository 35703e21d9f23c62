#include "fem/effects/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/effects/built_in.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::fem {

namespace {

bool is_in(Range range, double value) {
    switch (range) {
        case Range::positive:
            return value > 0;
        case Range::not_negative:
            return value >= 0;
        case Range::poisson:
            return value > -1 && value < 0.5;
        case Range::above_minus_one:
            return value > -1;
        case Range::share:
            return value >= 0 && value < 1;
        case Range::any:
            break;
    }
    return true;
}

// In the order of Range.
constexpr std::array<const char*, 6> range_words{
    "a number", "above 0", "at least 0", "above -1 and below 0.5", "above -1", "at least 0 and below 1"};

// " N/mm", or nothing.
std::string unit_words(const std::string& unit) { return unit == "1" ? "" : " " + unit; }

double checked(const EffectRecord& effect, const KnownParameter& known, const EffectParameter& given) {
    if (!given.unit.empty() && given.unit != known.unit)
        throw InvalidInput(fmt::format("effect '{}': {} is in {}, but must be in '{}'", effect.name, known.name,
                                       mesh::cited(given.unit), known.unit));
    if (!std::isfinite(given.value) || !is_in(known.range, given.value))
        throw InvalidInput(fmt::format("effect '{}': {} is {:.6g}{}, but must be {}", effect.name, known.name,
                                       given.value, unit_words(known.unit),
                                       range_words[static_cast<size_t>(known.range)]));
    return given.value;
}

EffectNumbers numbers_of(const EffectRecord& effect, const KnownEffect& known) {
    std::vector<std::string> names;
    names.reserve(known.parameters.size());
    for (const KnownParameter& parameter : known.parameters) names.push_back(parameter.name);
    for (const EffectParameter& parameter : effect.parameters)
        if (std::ranges::find(names, parameter.name) == names.end())
            throw InvalidInput(fmt::format("effect '{}': the parameter {} is not known{}; known are {}", effect.name,
                                           mesh::cited(parameter.name), mesh::suggestion(parameter.name, names),
                                           mesh::listed(names)));
    std::map<std::string, double> values;
    for (const KnownParameter& parameter : known.parameters) {
        const auto given = std::ranges::find(effect.parameters, parameter.name, &EffectParameter::name);
        if (given != effect.parameters.end())
            values[parameter.name] = checked(effect, parameter, *given);
        else if (!parameter.optional)
            throw InvalidInput(fmt::format("effect '{}': the parameter '{}' [{}] is missing", effect.name,
                                           parameter.name, parameter.unit));
    }
    return EffectNumbers(std::move(values));
}

}  // namespace

EffectRegistry::EffectRegistry() {
    for (KnownEffect& effect : built_in_effects()) effects_.push_back(std::move(effect));
}

EffectRegistry& EffectRegistry::instance() {
    static EffectRegistry registry;
    return registry;
}

void EffectRegistry::add(KnownEffect effect) {
    const std::scoped_lock lock(mutex_);
    if (find_unlocked(effect.name))
        throw InvalidInput(
            fmt::format("effect {} is known already; give yours another name", mesh::cited(effect.name)));
    effects_.push_back(std::move(effect));
}

const KnownEffect* EffectRegistry::find(const std::string& name) const {
    const std::scoped_lock lock(mutex_);
    return find_unlocked(name);
}

const KnownEffect* EffectRegistry::find_unlocked(const std::string& name) const {
    const auto found = std::ranges::find(effects_, name, &KnownEffect::name);
    return found == effects_.end() ? nullptr : &*found;
}

std::vector<std::string> EffectRegistry::names() const {
    const std::scoped_lock lock(mutex_);
    std::vector<std::string> names;
    names.reserve(effects_.size());
    for (const EffectKind kind : {EffectKind::body, EffectKind::measurement}) {
        for (const KnownEffect& effect : effects_) {
            if (effect.kind == kind) names.push_back(effect.name);
        }
    }
    return names;
}

const KnownEffect& EffectRegistry::of_body(const std::string& name) const {
    const KnownEffect* known = find(name);
    if (known && known->kind == EffectKind::body) return *known;
    if (known)
        throw InvalidInput(
            fmt::format("effect '{}' is about the measurement, not the body: no model can play it", name));
    const std::vector<std::string> all = names();
    throw InvalidInput(fmt::format("effect {} is not known{}; known are {}", mesh::cited(name),
                                   mesh::suggestion(name, all), mesh::listed(all)));
}

Effects EffectRegistry::make(const EffectRecord& given) const {
    const KnownEffect& known = of_body(given.name);
    const EffectNumbers numbers = numbers_of(given, known);
    try {
        return known.make(numbers);  // which may ask the registry
    } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("effect '{}': {}", given.name, error.what()));
    }
}

}  // namespace palpate::fem
