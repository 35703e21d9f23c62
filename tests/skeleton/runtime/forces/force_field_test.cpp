// The runtime's forces are those of the model in skeleton/.

#include <gtest/gtest.h>

#include "skeleton/runtime/forces/force_field.h"
#include "skeleton/runtime/walk_order.h"
#include "tests/skeleton/runtime/live_models.h"
#include "tests/surface_energies.h"

namespace palpate::runtime {
namespace {

using skeleton::testing::make_full_lattice;
using skeleton::testing::make_lattice;
using skeleton::testing::random_state;

// Largest difference of forces, and of energies from rest, in a random state; both as shares of their size.
struct Mismatch {
    double force, energy, tangent;
};

Mismatch mismatch(const skeleton::Model& model, double move, double turn, const Vec3& gravity = Vec3::Zero()) {
    std::mt19937_64 engine(3);
    const skeleton::State rest = skeleton::rest_state(model), state = random_state(model, engine, move, turn);
    skeleton::Load load;
    load.gravity = gravity;
    const Eigen::VectorXd expected = skeleton::residual(model, state, load);
    const double rise = skeleton::potential(model, state, load) - skeleton::potential(model, rest, load);

    const ReorderedModel reordered = in_cuthill_mckee_order(model);
    ForceField field(reordered.model);
    field.set_gravity(gravity);
    SphereRows force(rest_rows(reordered.model).size());
    const double at_rest = field.evaluate(rest_rows(reordered.model).data(), {}, force.data());
    const SphereRows pose = rows_of(reordered, state);
    const double there = field.evaluate(pose.data(), {}, force.data());

    const Eigen::MatrixXd J = skeleton::tangent(model, state, load);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(J.rows(), J.cols());
    const auto& blocks = field.curvature(pose.data());
    std::vector<int> number(model.spheres.size());
    for (std::size_t i = 0; i < number.size(); ++i) number[reordered.place[i]] = static_cast<int>(i);
    for (std::size_t p = 0; p < blocks.size(); ++p) {
        const Eigen::Index a = 6 * number[field.pairs()[p][0]], b = 6 * number[field.pairs()[p][1]];
        K.block<6, 6>(a, b) = blocks[p];
        K.block<6, 6>(b, a) = blocks[p].transpose();
    }
    const Eigen::VectorXd found = vector_of(reordered, force);
    return {(found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff(),
            std::abs(there - at_rest - rise) / std::abs(rise), (K - J).cwiseAbs().maxCoeff() / J.cwiseAbs().maxCoeff()};
}

// Both are sums of some dozens of terms in double precision (2e-16), on the way through quaternions in the one and
// matrices in the other.
constexpr double rounding = 1e-14;

TEST(ForceField, IsThatOfThePapersLinks) {
    const Mismatch by = mismatch(make_lattice({3, 3, 2}), 3, 0.5, {100, 200, -9810});
    EXPECT_LT(by.force, rounding);
    EXPECT_LT(by.energy, rounding);
    EXPECT_LT(by.tangent, rounding);
}

TEST(ForceField, IsThatOfFullLinksAndVolumes) {
    const Mismatch by = mismatch(make_full_lattice({3, 3, 2}), 3, 0.5);
    EXPECT_LT(by.force, rounding);
    EXPECT_LT(by.energy, rounding);
    EXPECT_LT(by.tangent, rounding);
}

TEST(ForceField, HoldsInLargeTurns) {
    for (const double turn : {1e-9, 1e-4, 1.0, 1.7}) {
        EXPECT_LT(mismatch(make_lattice({3, 2, 2}), 3, turn).force, rounding) << turn;
        EXPECT_LT(mismatch(make_full_lattice({3, 2, 2}), 3, turn).force, rounding) << turn;
    }
}

TEST(ForceField, PlaysTheEffectsOfTheLinksAndPoints) {
    for (const skeleton::EffectRecord& effect : playable_effects()) {
        for (skeleton::Model model : {make_lattice({3, 3, 2}), make_full_lattice({3, 3, 2})}) {
            give_skin(model);
            model.effects = {effect};
            const Mismatch by = mismatch(model, 0.5, 0.1);
            EXPECT_LT(by.force, rounding) << effect.name;
            EXPECT_LT(by.energy, rounding) << effect.name;
        }
    }
}

TEST(ForceField, CouplesWhatSectionsCouple) {
    // A frame of full links that keeps no volumes: fibres at an angle and a lump make the laws of its sections.
    skeleton::Model frame = make_full_lattice({3, 3, 2});
    for (skeleton::Sphere& sphere : frame.spheres) sphere.volume = 0;
    const skeleton::EffectRecord fibres{"anisotropy",
                                        {{"k", 3, "1"}, {"nx", 1, "1"}, {"ny", 1, "1"}, {"nz", -0.5, "1"}}};
    const skeleton::EffectRecord lump{
        "inclusion", {{"cx", 12, "mm"}, {"cy", 8, "mm"}, {"cz", 3, "mm"}, {"radius", 6, "mm"}, {"ratio", 8, "1"}}};
    const skeleton::EffectRecord stiffening{"stiffening", {{"c2", 3, "1"}, {"c3", 30, "1"}}};
    for (const auto& effects : {std::vector{fibres}, std::vector{lump}, std::vector{fibres, lump, stiffening}}) {
        frame.effects = effects;
        for (const double turn : {0.1, 1.0}) {
            const Mismatch by = mismatch(frame, 1, turn);
            EXPECT_LT(by.force, rounding) << effects.front().name << turn;
            EXPECT_LT(by.energy, rounding);
            EXPECT_LT(by.tangent, rounding);
        }
    }
}

TEST(ForceField, ACavityUnderPressurePushesAsItDoesInTheModel) {
    skeleton::Model model = make_full_lattice({3, 3, 2});
    give_skin(model);
    add_cavity(model);
    model.effects = {{"pressure", {{"pressure", 0.01, "MPa"}}}};
    const Mismatch by = mismatch(model, 0.5, 0.1);
    EXPECT_LT(by.force, rounding);
    EXPECT_LT(by.energy, rounding);
}

TEST(ForceField, TheSkinsAreaPullsAsItDoesInTheModel) {
    skeleton::register_effect({"tension-in-a-test", {{"gamma", "N/mm"}}, [](const skeleton::EffectNumbers& numbers) {
                                   return fem::Effects{.surface = {std::make_shared<Tension>(numbers["gamma"])}};
                               }});
    skeleton::Model model = make_full_lattice({3, 3, 2});
    give_skin(model);
    model.effects = {{"tension-in-a-test", {{"gamma", 0.01, "N/mm"}}}};
    const Mismatch by = mismatch(model, 0.5, 0.1);
    EXPECT_LT(by.force, rounding);
    EXPECT_LT(by.energy, rounding);
}

TEST(ForceField, DampingTakesEnergyAndKeepsMomenta) {
    skeleton::Model coupled = make_full_lattice({3, 2, 2});
    for (skeleton::Sphere& sphere : coupled.spheres) sphere.volume = 0;
    coupled.effects = {{"anisotropy", {{"k", 3, "1"}, {"nx", 1, "1"}, {"ny", 1, "1"}, {"nz", -0.5, "1"}}}};
    for (const skeleton::Model& model : {make_lattice({3, 2, 2}), make_full_lattice({3, 2, 2}), coupled}) {
        std::mt19937_64 engine(5);
        const ReorderedModel reordered = in_cuthill_mckee_order(model);
        ForceField field(reordered.model);
        const SphereRows pose = rows_of(reordered, random_state(model, engine, 2, 0.3));
        SphereRows velocity(pose.size(), 0.0), still(pose.size()), moving(pose.size());
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            for (int c = 0; c < 6; ++c) velocity[8 * i + c + c / 3] = skeleton::testing::random_vector(engine, 10).x();
        }
        field.evaluate(pose.data(), {}, still.data());
        field.evaluate(pose.data(), {velocity.data(), 1e-3}, moving.data());
        double power = 0, size = 0;
        Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            const auto at = [&](const SphereRows& rows, int offset) {
                return Vec3(Eigen::Map<const Vec3>(rows.data() + 8 * i + offset));
            };
            const Vec3 f = at(moving, 0) - at(still, 0), t = at(moving, 4) - at(still, 4);
            power += f.dot(at(velocity, 0)) + t.dot(at(velocity, 4));
            force += f;
            torque += t + at(pose, 0).cross(f);
            size += f.norm();
        }
        EXPECT_LT(power, 0);
        EXPECT_LT(force.norm(), rounding * size);
        EXPECT_LT(torque.norm(), 25 * rounding * size);  // arms are 25 mm at most
    }
}

TEST(ForceField, ARigidMotionIsNotDamped) {
    for (const skeleton::Model& model : {make_lattice({3, 2, 2}), make_full_lattice({3, 2, 2})}) {
        std::mt19937_64 engine(5);
        const ReorderedModel reordered = in_cuthill_mckee_order(model);
        ForceField field(reordered.model);
        const SphereRows pose = rows_of(reordered, random_state(model, engine, 2, 0.3));
        SphereRows velocity(pose.size(), 0.0), still(pose.size()), moving(pose.size());
        const Vec3 v(10, -20, 5), w(1, 2, -3);
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            Eigen::Map<Vec3> linear(velocity.data() + 8 * i), angular(velocity.data() + 8 * i + 4);
            linear = v + w.cross(Eigen::Map<const Vec3>(pose.data() + 8 * i));
            angular = w;
        }
        field.evaluate(pose.data(), {}, still.data());
        field.evaluate(pose.data(), {velocity.data(), 1e-3}, moving.data());
        double most = 0, size = 0;
        for (std::size_t i = 0; i < still.size(); ++i) {
            most = std::max(most, std::abs(moving[i] - still[i]));
            size = std::max(size, std::abs(still[i]));
        }
        EXPECT_LT(most, rounding * size);
    }
}

}  // namespace
}  // namespace palpate::runtime
