#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "skeleton/effects/link_effects.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::force_at;
using testing::gravity;
using testing::make_chain;
using testing::with_effects;

// Numbers that every effect takes, in the units of the catalogue.
const std::vector<EffectRecord> all_effects{
    gravity({0, 0, -9810}),
    {"compliant-support", {{"stiffness", 5, "N/mm"}}},
    {"stiffening", {{"c2", 0.5, "1"}, {"c3", 0, "1"}}},
    {"anisotropy", {{"k", 2, "1"}, {"nx", 2, "1"}, {"ny", 0, "1"}, {"nz", 0, "1"}}},
    {"inclusion", {{"cx", 10, "mm"}, {"cy", 0, "mm"}, {"cz", 0, "mm"}, {"radius", 5, "mm"}, {"ratio", 3, "1"}}},
    {"contact", {{"nx", 0, "1"}, {"ny", 0, "1"}, {"nz", 2, "1"}, {"offset", -3, "mm"}, {"stiffness", 0.1, "N/mm^3"}}},
    {"map",
     {{"length", 8, "mm"},
      {"x1", 5, "mm"},
      {"y1", 0, "mm"},
      {"z1", 0, "mm"},
      {"a1", 0.5, "1"},
      {"x2", 25, "mm"},
      {"y2", 0, "mm"},
      {"z2", 0, "mm"},
      {"a2", -0.5, "1"}}},
    {"pressure", {{"pressure", 0.01, "MPa"}}},
    {"prestress",
     {{"sxx", 0.1, "1"}, {"syy", 0.2, "1"}, {"szz", 0, "1"}, {"sxy", 0.3, "1"}, {"syz", 0, "1"}, {"sxz", 0, "1"}}},
    {"swelling", {{"growth", -0.02, "1"}}},
    {"viscosity", {{"creep", 0.7, "1"}, {"tau", 20, "s"}}},
    {"plasticity", {{"yield", 0.05, "1"}, {"hardening", 0.1, "1"}}},
    {"damage", {{"share", 0.4, "1"}, {"strain", 0.07, "1"}}},
    {"friction", {{"tendons", 0.2, "1"}}},
    {"volume", {{"poisson", 0.3, "1"}}},
    {"local-force",
     {{"cx", 10, "mm"},
      {"cy", 0, "mm"},
      {"cz", 0, "mm"},
      {"radius", 5, "mm"},
      {"fx", 0, "N"},
      {"fy", 0.1, "N"},
      {"fz", 0, "N"}}},
    {"local-springs",
     {{"cx", 10, "mm"}, {"cy", 0, "mm"}, {"cz", 0, "mm"}, {"radius", 5, "mm"}, {"stiffness", 0.2, "N/mm"}}},
    {"local-swelling", {{"cx", 10, "mm"}, {"cy", 0, "mm"}, {"cz", 0, "mm"}, {"radius", 5, "mm"}, {"growth", 0.3, "1"}}},
    {"torsion", {{"torsion", 0.5, "1"}}},
    {"shear", {{"shear", 0.5, "1"}}},
};

const EffectRecord& effect_of_list(const std::string& name) {
    return *std::ranges::find(all_effects, name, &EffectRecord::name);
}

TEST(KnownEffects, AreAllThatABodyMayHave) {
    for (const EffectRecord& effect : all_effects) {
        EXPECT_TRUE(is_body_effect(effect.name));
        ASSERT_NE(find_known_effect(effect.name), nullptr) << effect.name;
        // A solid has its ratio in its law, and friction is nothing without tendons.
        EXPECT_EQ(make_physics(effect).empty(), effect.name == "volume" || effect.name == "friction") << effect.name;
    }
}

TEST(KnownEffects, TellTheirNumbers) {
    const fem::Effects physics = physics_of(all_effects);
    EXPECT_EQ(physics.points.size(), 5u);    // gravity, support, contact, a force and springs in one place
    EXPECT_EQ(physics.material.size(), 5u);  // stiffening, anisotropy, inclusion, map, prestress
    EXPECT_EQ(physics.pressure, 0.01);
    EXPECT_EQ(physics.growth.everywhere, -0.02);
    EXPECT_DOUBLE_EQ(physics.growth.at({10, 5, 0}), -0.02 + 0.3 * std::exp(-0.5));
    EXPECT_EQ(link_effects(physics).torsion, 0.5);
    EXPECT_EQ(link_effects(physics).shear, 0.5);
    EXPECT_EQ(physics.creep->creep, 0.7);
    EXPECT_EQ(physics.creep->tau, 20);
    EXPECT_EQ(physics.plasticity->yield, 0.05);
    EXPECT_EQ(physics.plasticity->hardening, 0.1);
    EXPECT_EQ(physics.damage->share, 0.4);
    EXPECT_EQ(physics.damage->strain, 0.07);
    EXPECT_EQ(physics.tendon_friction, 0.2);

    const auto w = [](const EffectRecord& effect, const Mat3& F) {
        return make_physics(effect).material[0]->terms(Vec3::Zero(), F, false).w;
    };
    Mat3 F = Mat3::Identity();
    F(0, 1) = 0.2;  // E_xy = 0.1, E_yy = 0.02
    EXPECT_NEAR(w(effect_of_list("prestress"), F), 0.3 * 2 * 0.1 + 0.2 * 0.02, 1e-15);
    F = Vec3(1.2, 1, 1).asDiagonal();
    EXPECT_NEAR(w(effect_of_list("anisotropy"), F), 0.5 * 2 * 0.22 * 0.22,
                1e-15);  // the direction's length does not matter
    EXPECT_DOUBLE_EQ(make_physics(effect_of_list("inclusion")).material[0]->stiffness({10, 1, 0}), 3);
}

TEST(KnownEffects, HaveSecondForms) {
    EffectRecord two = effect_of_list("anisotropy");
    for (const EffectParameter& more :
         std::initializer_list<EffectParameter>{{"k2", 1, "1"}, {"n2x", 0, "1"}, {"n2y", 1, "1"}, {"n2z", 0, "1"}})
        two.parameters.push_back(more);
    const Mat3 F = Vec3(1.2, 1.1, 1).asDiagonal();
    EXPECT_NEAR(make_physics(two).material[0]->terms(Vec3::Zero(), F, false).w, 0.5 * (2 * 0.22 * 0.22 + 0.105 * 0.105),
                1e-15);

    const EffectRecord box{"inclusion",
                           {{"cx", 0, "mm"},
                            {"cy", 0, "mm"},
                            {"cz", 0, "mm"},
                            {"ratio", 0.5, "1"},
                            {"hx", 1, "mm"},
                            {"hy", 20, "mm"},
                            {"hz", 1, "mm"}}};
    EXPECT_DOUBLE_EQ(make_physics(box).material[0]->stiffness({0, 15, 0}), 0.5);
    EXPECT_DOUBLE_EQ(make_physics(box).material[0]->stiffness({15, 0, 0}), 1);
}

TEST(VolumeEffect, IsPlayedByNoLink) {
    const Model model = make_chain(3);
    const Load load = force_at(model, 3, {0.1, 0.1, 0});
    EXPECT_EQ(equilibrium(with_effects(model, {effect_of_list("volume")}), load).step, equilibrium(model, load).step);
}

// --- A user's own -------------------------------------------------------------------------------------------------

// A wind along x: a dead force on all masses.
class Wind : public fem::PointPotential {
public:
    explicit Wind(double a) : a_(a) {}
    fem::ActsOn acts_on() const override { return fem::ActsOn::material; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override {
        return {.energy = -a_ * (x - X).x(), .gradient = -a_ * Vec3::UnitX(), .hessian = Mat3::Zero()};
    }

private:
    double a_;  // [mm/s^2]
};

KnownEffect wind(const std::string& name) {
    return {name, {{"speed", "mm/s", Range::positive}}, [](const EffectNumbers& numbers) {
                return fem::Effects{.points = {std::make_shared<Wind>(10 * numbers["speed"])}};
            }};
}

const bool wind_is_known = register_effect(wind("wind"));

TEST(RegisteredEffect, IsPlayedAsAnyOther) {
    ASSERT_TRUE(wind_is_known);
    const EffectRecord blowing{"wind", {{"speed", 2e4, "mm/s"}}};
    const Equilibrium found = equilibrium(with_effects(make_chain(1), {blowing}), {});
    EXPECT_NEAR(found.step[6], 2e5 * 1e-6 / 2, 1e-9);  // a m / kE
    EXPECT_EQ(message_of([] {
                  make_physics({"wind", {{"speed", 0, "mm/s"}}});
              }),
              "effect 'wind': speed is 0 mm/s, but must be above 0");
}

TEST(RegisteredEffect, NeedsANameOfItsOwn) {
    for (const char* name : {"wind", "gravity", "outliers"})
        EXPECT_EQ(message_of([&] { register_effect(wind(name)); }),
                  "effect '" + std::string(name) + "' is known already; give yours another name");
}

TEST(RegisteredEffect, MayComeFromAnyThread) {
    const KnownEffect* before = find_known_effect("gravity");
    std::vector<std::thread> threads;
    threads.reserve(4);
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([t] {
            for (int i = 0; i < 50; ++i) {
                const std::string name = "wind-" + std::to_string(t) + "-" + std::to_string(i);
                register_effect(wind(name));
                EXPECT_NE(find_known_effect(name), nullptr);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(find_known_effect("gravity"), before);
}

}  // namespace
}  // namespace palpate::skeleton
