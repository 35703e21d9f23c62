#include "fem/effects/built_in.h"

#include "fem/effects/anisotropy.h"
#include "fem/effects/compliant_support.h"
#include "fem/effects/contact.h"
#include "fem/effects/gravity.h"
#include "fem/effects/inclusion.h"
#include "fem/effects/prestress.h"
#include "fem/effects/stiffening.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

KnownParameter optional(std::string name, std::string unit, Range range = Range::any) {
    return {std::move(name), std::move(unit), range, true};
}

Vec3 direction(const EffectNumbers& numbers, const std::string& n) {
    const Vec3 v = numbers.vector(n + "x", n + "y", n + "z");
    if (v.isZero(0)) throw InvalidInput(n + "x, " + n + "y and " + n + "z are all 0, but must give a direction");
    return v.normalized();
}

Effects in_points(std::shared_ptr<const PointPotential> potential) { return {.points = {std::move(potential)}}; }

Effects in_material(std::shared_ptr<const MaterialEffect> effect) { return {.material = {std::move(effect)}}; }

Effects gravity(const EffectNumbers& numbers) {
    return in_points(std::make_shared<Gravity>(numbers.vector("gx", "gy", "gz")));
}

Effects compliant_support(const EffectNumbers& numbers) {
    const double turning = numbers.has("turning") ? numbers["turning"] : 1;
    return in_points(std::make_shared<CompliantSupport>(numbers["stiffness"], turning));
}

Effects contact(const EffectNumbers& numbers) {
    return in_points(std::make_shared<ContactPlane>(direction(numbers, "n"), numbers["offset"], numbers["stiffness"]));
}

Effects stiffening(const EffectNumbers& numbers) {
    return in_material(std::make_shared<Stiffening>(numbers["c2"], numbers["c3"]));
}

Effects anisotropy(const EffectNumbers& numbers) {
    std::vector<Fibre> fibres{{numbers["k"], direction(numbers, "n")}};
    int given = 0;
    for (const char* name : {"k2", "n2x", "n2y", "n2z"}) given += numbers.has(name) ? 1 : 0;
    if (given != 0 && given != 4) throw InvalidInput("a second family of fibres needs all of k2, n2x, n2y and n2z");
    if (given == 4) fibres.push_back({numbers["k2"], direction(numbers, "n2")});
    return in_material(std::make_shared<Anisotropy>(std::move(fibres)));
}

Effects inclusion(const EffectNumbers& numbers) {
    const Vec3 centre = numbers.vector("cx", "cy", "cz");
    int sides = 0;
    for (const char* name : {"hx", "hy", "hz"}) sides += numbers.has(name) ? 1 : 0;
    if (numbers.has("radius") ? sides != 0 : sides != 3)
        throw InvalidInput("either a radius [mm] is needed, for a ball, or hx, hy and hz [mm], for a box");
    return in_material(std::make_shared<Inclusion>(
        numbers.has("radius") ? Inclusion::sphere(centre, numbers["radius"], numbers["ratio"])
                              : Inclusion::box(centre, numbers.vector("hx", "hy", "hz"), numbers["ratio"])));
}

Effects prestress(const EffectNumbers& numbers) {
    Mat3 S;
    S << numbers["sxx"], numbers["sxy"], numbers["sxz"],  //
        numbers["sxy"], numbers["syy"], numbers["syz"],   //
        numbers["sxz"], numbers["syz"], numbers["szz"];
    return in_material(std::make_shared<Prestress>(S));
}

Effects pressure(const EffectNumbers& numbers) { return {.pressure = numbers["pressure"]}; }

Effects viscosity(const EffectNumbers& numbers) { return {.creep = CreepLaw{numbers["creep"], numbers["tau"]}}; }

Effects plasticity(const EffectNumbers& numbers) {
    return {.plasticity = Plasticity{numbers["yield"], numbers["hardening"]}};
}

// Recorded only: a solid has Poisson's ratio in its law, and links have no volume that could resist.
Effects volume(const EffectNumbers&) { return {}; }

}  // namespace

std::vector<KnownEffect> built_in_effects() {
    constexpr Range positive = Range::positive, not_negative = Range::not_negative;
    return {
        {"gravity", {{"gx", "mm/s^2"}, {"gy", "mm/s^2"}, {"gz", "mm/s^2"}}, gravity},
        {"compliant-support",
         {{"stiffness", "N/mm", positive}, optional("turning", "1", Range::positive)},
         compliant_support},
        {"stiffening", {{"c2", "1", not_negative}, {"c3", "1", not_negative}}, stiffening},
        {"anisotropy",
         {{"k", "1"},
          {"nx", "1"},
          {"ny", "1"},
          {"nz", "1"},
          optional("k2", "1"),
          optional("n2x", "1"),
          optional("n2y", "1"),
          optional("n2z", "1")},
         anisotropy},
        {"inclusion",
         {{"cx", "mm"},
          {"cy", "mm"},
          {"cz", "mm"},
          optional("radius", "mm", positive),
          optional("hx", "mm", positive),
          optional("hy", "mm", positive),
          optional("hz", "mm", positive),
          {"ratio", "1", positive}},
         inclusion},
        {"contact",
         {{"nx", "1"}, {"ny", "1"}, {"nz", "1"}, {"offset", "mm"}, {"stiffness", "N/mm^3", positive}},
         contact},
        {"pressure", {{"pressure", "MPa"}}, pressure},
        {"prestress", {{"sxx", "1"}, {"syy", "1"}, {"szz", "1"}, {"sxy", "1"}, {"syz", "1"}, {"sxz", "1"}}, prestress},
        {"viscosity", {{"creep", "1", not_negative}, {"tau", "s", positive}}, viscosity},
        {"plasticity", {{"yield", "1", positive}, {"hardening", "1", not_negative}}, plasticity},
        {.name = "volume",
         .parameters = {{"poisson", "1", Range::poisson}},
         .make = volume,
         .not_played = "acts on solids alone: a skeleton's volumes have stiffnesses of their own"},
        {"misalignment", {}, {}, EffectKind::measurement},
        {"force-gain", {}, {}, EffectKind::measurement},
        {"outliers", {}, {}, EffectKind::measurement},
    };
}

}  // namespace palpate::fem
