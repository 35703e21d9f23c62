#include "fem/effects/built_in.h"

#include "fem/effects/local/known_locality.h"
#include "fem/effects/local/local_force.h"
#include "fem/effects/local/local_springs.h"
#include "fem/effects/local/stiffness_map.h"
#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "fem/effects/point/compliant_support.h"
#include "fem/effects/point/contact.h"
#include "fem/effects/point/gravity.h"

namespace palpate::fem {

namespace {

// Those whose physics is a number that the body itself heeds.

KnownEffect known_pressure() {
    return {"pressure", {{"pressure", "MPa"}}, [](const EffectNumbers& numbers) -> Effects {
                return {.pressure = numbers["pressure"]};
            }};
}

/// Growth::Part.
KnownEffect known_local_swelling() {
    std::vector<KnownParameter> parameters = locality_parameters();
    parameters.push_back({"growth", "1", Range::above_minus_one});
    return {"local-swelling", std::move(parameters), [](const EffectNumbers& numbers) -> Effects {
                return {.growth = {.parts = {{locality(numbers), numbers["growth"]}}}};
            }};
}

KnownEffect known_swelling() {
    return {"swelling", {{"growth", "1", Range::above_minus_one}}, [](const EffectNumbers& numbers) -> Effects {
                return {.growth = {.everywhere = numbers["growth"]}};
            }};
}

KnownEffect known_viscosity() {
    return {"viscosity",
            {{"creep", "1", Range::not_negative}, {"tau", "s", Range::positive}},
            [](const EffectNumbers& numbers) -> Effects {
                return {.creep = CreepLaw{numbers["creep"], numbers["tau"]}};
            }};
}

KnownEffect known_plasticity() {
    return {"plasticity",
            {{"yield", "1", Range::positive}, {"hardening", "1", Range::not_negative}},
            [](const EffectNumbers& numbers) -> Effects {
                return {.plasticity = Plasticity{numbers["yield"], numbers["hardening"]}};
            }};
}

KnownEffect known_damage() {
    return {"damage",
            {{"share", "1", Range::share}, {"strain", "1", Range::positive}},
            [](const EffectNumbers& numbers) -> Effects {
                return {.damage = Damage{numbers["share"], numbers["strain"]}};
            }};
}

KnownEffect known_friction() {
    return {.name = "friction",
            .parameters = {{"tendons", "1", Range::not_negative}},
            .make = [](const EffectNumbers& numbers) -> Effects { return {.tendon_friction = numbers["tendons"]}; },
            .not_played = "is of tendons, and a model has none of its own"};
}

// Recorded only: a solid has Poisson's ratio in its law, and links have no volume that could resist.
KnownEffect known_volume() {
    return {.name = "volume",
            .parameters = {{"poisson", "1", Range::poisson}},
            .make = [](const EffectNumbers&) { return Effects{}; },
            .not_played = "acts on solids alone: a skeleton's volumes have stiffnesses of their own"};
}

KnownEffect fault(std::string name) { return {std::move(name), {}, {}, EffectKind::measurement}; }

}  // namespace

std::vector<KnownEffect> built_in_effects() {
    return {
        known_gravity(),       known_compliant_support(), known_stiffening(),    known_anisotropy(),
        known_inclusion(),     known_stiffness_map(),     known_contact(),       known_pressure(),
        known_prestress(),     known_swelling(),          known_viscosity(),     known_plasticity(),
        known_damage(),        known_friction(),          known_volume(),        known_local_force(),
        known_local_springs(), known_local_swelling(),    fault("misalignment"), fault("force-gain"),
        fault("slip"),         fault("actuation-gain"),   fault("clock"),        fault("outliers"),
    };
}

}  // namespace palpate::fem
