#include "identify/effects/catalogue.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {

// Each effect, from its own file.
std::shared_ptr<const EffectHypothesis> gravity_effect();
std::shared_ptr<const EffectHypothesis> stiffening_effect();
std::shared_ptr<const EffectHypothesis> anisotropy_effect();
std::shared_ptr<const EffectHypothesis> inclusion_effect();
std::shared_ptr<const EffectHypothesis> stiffness_map_effect();
std::shared_ptr<const EffectHypothesis> volume_effect();
std::shared_ptr<const EffectHypothesis> torsion_effect();
std::shared_ptr<const EffectHypothesis> shear_effect();
std::shared_ptr<const EffectHypothesis> compliant_support_effect();
std::shared_ptr<const EffectHypothesis> contact_effect();
std::shared_ptr<const EffectHypothesis> pressure_effect();
std::shared_ptr<const EffectHypothesis> prestress_effect();
std::shared_ptr<const EffectHypothesis> swelling_effect();
std::shared_ptr<const EffectHypothesis> viscosity_effect();
std::shared_ptr<const EffectHypothesis> plasticity_effect();
std::shared_ptr<const EffectHypothesis> damage_effect();
std::shared_ptr<const EffectHypothesis> friction_effect();
std::shared_ptr<const EffectHypothesis> misalignment_effect();
std::shared_ptr<const EffectHypothesis> force_gain_effect();
std::shared_ptr<const EffectHypothesis> slip_effect();
std::shared_ptr<const EffectHypothesis> actuation_gain_effect();
std::shared_ptr<const EffectHypothesis> clock_effect();
std::shared_ptr<const EffectHypothesis> outliers_effect();
std::shared_ptr<const EffectHypothesis> local_force_effect();
std::shared_ptr<const EffectHypothesis> local_springs_effect();
std::shared_ptr<const EffectHypothesis> local_swelling_effect();

namespace {

std::vector<std::shared_ptr<const EffectHypothesis>>& registry() {
    static std::vector<std::shared_ptr<const EffectHypothesis>> all{
        gravity_effect(),      stiffening_effect(), anisotropy_effect(),   inclusion_effect(),
        volume_effect(),       torsion_effect(),    shear_effect(),        compliant_support_effect(),
        contact_effect(),      pressure_effect(),   prestress_effect(),    swelling_effect(),
        viscosity_effect(),    plasticity_effect(), damage_effect(),       friction_effect(),
        misalignment_effect(), force_gain_effect(), slip_effect(),         actuation_gain_effect(),
        clock_effect(),        outliers_effect(),   stiffness_map_effect()};
    return all;
}

}  // namespace

const std::vector<std::shared_ptr<const EffectHypothesis>>& catalogue() { return registry(); }

bool register_effect(skeleton::KnownEffect physics, std::shared_ptr<const EffectHypothesis> effect) {
    const EffectDescription& text = effect->description();
    if (effect_named(text.name))
        throw InvalidInput(fmt::format("there is an effect '{}' already; give yours another name", text.name));
    if (physics.name != text.name || physics.kind != text.kind)
        throw InvalidInput(
            fmt::format("effect '{}' of the {} is given the physics of '{}' of the {}; name and kind must agree",
                        text.name, fem::kind_name(text.kind), physics.name, fem::kind_name(physics.kind)));
    skeleton::register_effect(std::move(physics));
    registry().push_back(std::move(effect));
    return true;
}

const std::vector<std::shared_ptr<const EffectHypothesis>>& unnamed_sources() {
    static const std::vector<std::shared_ptr<const EffectHypothesis>> all{local_force_effect(), local_springs_effect(),
                                                                          local_swelling_effect()};
    return all;
}

std::vector<std::shared_ptr<const EffectHypothesis>> all_effects() {
    std::vector<std::shared_ptr<const EffectHypothesis>> all = catalogue();
    all.insert(all.end(), unnamed_sources().begin(), unnamed_sources().end());
    return all;
}

std::shared_ptr<const EffectHypothesis> effect_named(const std::string& name) {
    const auto effects = all_effects();
    const auto found = std::ranges::find(effects, name, [](const auto& effect) { return effect->name(); });
    return found == effects.end() ? nullptr : *found;
}

std::shared_ptr<const EffectHypothesis> effect_of_single_readings() {
    return *std::ranges::find_if(catalogue(), &EffectHypothesis::sets_readings_aside);
}

std::shared_ptr<const EffectHypothesis> find_effect(const std::string& name) {
    if (auto effect = effect_named(name)) return effect;
    std::vector<std::string> names;
    for (const auto& effect : all_effects()) names.push_back(effect->name());
    throw InvalidInput(fmt::format("effect '{}' is not known{}; known are {}", name, mesh::suggestion(name, names),
                                   mesh::listed(names)));
}

}  // namespace palpate::identify
