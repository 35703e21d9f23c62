#include "skeleton/effects/effect.h"

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::compliant_support;
using testing::force_at;
using testing::gravity;
using testing::make_chain;
using testing::make_lattice;
using testing::Slope;
using testing::with_effects;

std::string complaint(const EffectRecord& effect) {
    return message_of([&] { make_physics(effect); });
}

TEST(EffectMessages, EveryFaultIsNamed) {
    // Those of other tests follow, then those of a measurement.
    EXPECT_EQ(
        complaint({"gravitty", {}})
            .rfind("effect 'gravitty' is not known (did you mean 'gravity'?); known are 'gravity', "
                   "'compliant-support', 'stiffening', 'anisotropy', 'inclusion', 'map', 'contact', 'pressure', "
                   "'prestress', 'swelling', 'viscosity', 'plasticity', 'damage', 'friction', 'volume', 'local-force', "
                   "'local-springs', 'local-swelling', 'torsion', 'shear', ",
                   0),
        0u);
    EXPECT_EQ(complaint({"outliers", {}}),
              "effect 'outliers' is about the measurement, not the body: no model can play it");
    EXPECT_EQ(complaint({"swelling", {{"growth", -1, ""}}}), "effect 'swelling': growth is -1, but must be above -1");
    EXPECT_EQ(complaint({"damage", {{"share", 1, ""}, {"strain", 0.1, ""}}}),
              "effect 'damage': share is 1, but must be at least 0 and below 1");
    EXPECT_EQ(complaint({"gravity", {{"gx", 0, ""}, {"gy", 0, ""}}}),
              "effect 'gravity': the parameter 'gz' [mm/s^2] is missing");
    EXPECT_EQ(
        complaint({"compliant-support", {{"stifness", 3, "N/mm"}}}),
        "effect 'compliant-support': the parameter 'stifness' is not known (did you mean 'stiffness'?); known are "
        "'stiffness', 'turning'");
    EXPECT_EQ(complaint(compliant_support(0)), "effect 'compliant-support': stiffness is 0 N/mm, but must be above 0");
    EXPECT_EQ(complaint(gravity({0, std::nan(""), 0})), "effect 'gravity': gy is nan mm/s^2, but must be a number");
    EXPECT_EQ(complaint({"compliant-support", {{"stiffness", 3, "N/m"}}}),
              "effect 'compliant-support': stiffness is in 'N/m', but must be in 'N/mm'");
    EXPECT_EQ(complaint({"stiffening", {{"c2", 1, "1"}, {"c3", -1, "1"}}}),
              "effect 'stiffening': c3 is -1, but must be at least 0");
    EXPECT_EQ(complaint({"volume", {{"poisson", 0.5, "1"}}}),
              "effect 'volume': poisson is 0.5, but must be above -1 and below 0.5");
}

TEST(EffectMessages, WhatDoesNotGoTogetherIsNamed) {
    const EffectParameter cx{"cx", 0, "mm"}, cy{"cy", 0, "mm"}, cz{"cz", 0, "mm"}, ratio{"ratio", 2, "1"};
    const EffectParameter radius{"radius", 3, "mm"}, hx{"hx", 3, "mm"};
    const std::string either =
        "effect 'inclusion': either a radius [mm] is needed, for a ball, or hx, hy and hz [mm], for a box";
    EXPECT_EQ(complaint({"inclusion", {cx, cy, cz, ratio}}), either);
    EXPECT_EQ(complaint({"inclusion", {cx, cy, cz, hx, ratio}}), either);
    EXPECT_EQ(complaint({"inclusion", {cx, cy, cz, radius, hx, ratio}}), either);
    const fem::EffectParameter length{"length", 8, "mm"}, a1{"a1", 0.5, ""}, x1{"x1", 5, ""}, y1{"y1", 0, ""};
    EXPECT_EQ(complaint({"map", {length}}),
              "effect 'map': it has no places: x1, y1, z1 [mm] and a1, and so on, must be given");
    EXPECT_EQ(complaint({"map", {length, x1, y1, a1}}), "effect 'map': 'z1' [mm] is missing, of the place of a1");
    EXPECT_EQ(complaint({"map", {length, x1, y1, {"z1", 0, ""}, a1, {"a3", 1, ""}}}),
              "effect 'map': 'a3' is given, but a2 is not: places are numbered from 1 without gaps");
    EXPECT_EQ(complaint({"anisotropy", {{"k", 1, "1"}, {"nx", 0, "1"}, {"ny", 0, "1"}, {"nz", 0, "1"}}}),
              "effect 'anisotropy': nx, ny and nz are all 0, but must give a direction");
    EXPECT_EQ(complaint({"anisotropy", {{"k", 1, ""}, {"nx", 1, ""}, {"ny", 0, ""}, {"nz", 0, ""}, {"k2", 1, ""}}}),
              "effect 'anisotropy': a second family of fibres needs all of k2, n2x, n2y and n2z");
}

TEST(EffectMessages, NothingToActOn) {
    Model model = with_effects(make_chain(2), {compliant_support(1)});
    model.spheres[0].held = false;
    EXPECT_EQ(message_of([&] { equilibrium(model, {}); }),
              "none of the model's 3 spheres is held, so an effect of the support has nothing to act on: let a support "
              "hold one, or set its 'held' to true");
    EXPECT_EQ(message_of([] { StaticsSolver(make_chain(2), {.points = {std::make_shared<Slope>(1, 1)}}); }),
              "the model has no skin, on which an effect acts: give it one, or take the effect away");
}

TEST(EffectsOfAMeasurement, AreNotPlayed) {
    for (const char* name : {"misalignment", "force-gain", "slip", "actuation-gain", "clock", "outliers"})
        EXPECT_FALSE(is_body_effect(name));
    EXPECT_TRUE(is_body_effect("gravity"));
    const Model model = make_lattice({4, 2, 2});
    const Load load = force_at(model, 3, {1, 2, -3});
    EXPECT_EQ(equilibrium(with_effects(model, {{"force-gain", {{"gain", 2, ""}}}}), load).step,
              equilibrium(model, load).step);
}

}  // namespace
}  // namespace palpate::skeleton
