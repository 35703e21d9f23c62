#include "skeleton/effects/effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>

#include "mesh/errors.h"
#include "mesh/io/words.h"
#include "skeleton/effects/known_effects.h"
#include "skeleton/effects/link_effects.h"

namespace palpate::skeleton {

namespace {

// All effects, those of users after those that are known from the start.
class Registry {
public:
    static Registry& instance() {
        static Registry registry;
        return registry;
    }

    const KnownEffect* find(const std::string& name) const {
        const std::scoped_lock lock(mutex_);
        return find_unlocked(name);
    }

    void add(KnownEffect effect) {
        const std::scoped_lock lock(mutex_);
        if (find_unlocked(effect.name))
            throw InvalidInput(
                fmt::format("effect {} is known already; give yours another name", mesh::cited(effect.name)));
        effects_.push_back(std::move(effect));
    }

    // Those of bodies first, then those of measurements.
    std::vector<std::string> names() const {
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

private:
    Registry() {
        for (KnownEffect& effect : known_effects()) effects_.push_back(std::move(effect));
        for (KnownEffect& effect : known_link_effects()) effects_.push_back(std::move(effect));
    }
    const KnownEffect* find_unlocked(const std::string& name) const {
        const auto found = std::ranges::find(effects_, name, &KnownEffect::name);
        return found == effects_.end() ? nullptr : &*found;
    }

    mutable std::mutex mutex_;
    std::deque<KnownEffect> effects_;  // which stay where they are when others come
};

const KnownEffect& find_effect(const std::string& name) {
    const KnownEffect* known = find_known_effect(name);
    if (known && known->kind == EffectKind::body) return *known;
    if (known)
        throw InvalidInput(
            fmt::format("effect '{}' is about the measurement, not the body: no model can play it", name));
    const std::vector<std::string> names = Registry::instance().names();
    throw InvalidInput(fmt::format("effect {} is not known{}; known are {}", mesh::cited(name),
                                   mesh::suggestion(name, names), mesh::listed(names)));
}

bool is_in(Range range, double value) {
    switch (range) {
        case Range::positive:
            return value > 0;
        case Range::not_negative:
            return value >= 0;
        case Range::poisson:
            return value > -1 && value < 0.5;
        case Range::any:
            break;
    }
    return true;
}

// In the order of Range.
constexpr std::array<const char*, 4> range_words{"a number", "above 0", "at least 0", "above -1 and below 0.5"};

// " N/mm", or nothing.
std::string unit_words(const std::string& unit) { return unit == "1" ? "" : " " + unit; }

double checked(const Effect& effect, const KnownParameter& known, const EffectParameter& told) {
    if (!told.unit.empty() && told.unit != known.unit)
        throw InvalidInput(fmt::format("effect '{}': {} is in {}, but must be in '{}'", effect.name, known.name,
                                       mesh::cited(told.unit), known.unit));
    if (!std::isfinite(told.value) || !is_in(known.range, told.value))
        throw InvalidInput(fmt::format("effect '{}': {} is {:.6g}{}, but must be {}", effect.name, known.name,
                                       told.value, unit_words(known.unit),
                                       range_words[static_cast<size_t>(known.range)]));
    return told.value;
}

EffectNumbers numbers_of(const Effect& effect, const KnownEffect& known) {
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
        const auto told = std::ranges::find(effect.parameters, parameter.name, &EffectParameter::name);
        if (told != effect.parameters.end())
            values[parameter.name] = checked(effect, parameter, *told);
        else if (!parameter.optional)
            throw InvalidInput(fmt::format("effect '{}': the parameter '{}' [{}] is missing", effect.name,
                                           parameter.name, parameter.unit));
    }
    return EffectNumbers(std::move(values));
}

}  // namespace

bool register_effect(KnownEffect effect) {
    Registry::instance().add(std::move(effect));
    return true;
}

const KnownEffect* find_known_effect(const std::string& name) { return Registry::instance().find(name); }

bool is_body_effect(const std::string& name) {
    const KnownEffect* known = find_known_effect(name);
    return !known || known->kind == EffectKind::body;
}

fem::Effects make_physics(const Effect& effect) {
    const KnownEffect& known = find_effect(effect.name);
    const EffectNumbers numbers = numbers_of(effect, known);
    try {
        return known.make(numbers);
    } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("effect '{}': {}", effect.name, error.what()));
    }
}

fem::Effects physics_of(const std::vector<Effect>& effects, const fem::Effects& more) {
    fem::Effects physics;
    for (const Effect& effect : effects)
        if (is_body_effect(effect.name)) physics.add(make_physics(effect));
    physics.add(more);
    return physics;
}

}  // namespace palpate::skeleton
