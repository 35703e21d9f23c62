#include "skeleton/effects/effect.h"

#include "fem/effects/registry.h"
#include "skeleton/effects/link_effects.h"

namespace palpate::skeleton {

namespace {

/// Those of links come after a body's and before users', whoever asks first: static objects of other files may.
fem::EffectRegistry& registry() {
    static fem::EffectRegistry& all = []() -> fem::EffectRegistry& {
        fem::EffectRegistry& known = fem::EffectRegistry::instance();
        for (KnownEffect& effect : known_link_effects()) known.add(std::move(effect));
        return known;
    }();
    return all;
}

}  // namespace

bool register_effect(KnownEffect effect) {
    registry().add(std::move(effect));
    return true;
}

const KnownEffect* find_known_effect(const std::string& name) { return registry().find(name); }

bool is_body_effect(const std::string& name) {
    const KnownEffect* known = find_known_effect(name);
    return !known || known->kind == EffectKind::body;
}

fem::Effects make_physics(const EffectRecord& effect) { return registry().make(effect); }

fem::Effects physics_of(const std::vector<EffectRecord>& effects, const fem::Effects& more) {
    fem::Effects physics;
    for (const EffectRecord& effect : effects)
        if (is_body_effect(effect.name)) physics.add(make_physics(effect));
    physics.add(more);
    return physics;
}

}  // namespace palpate::skeleton
