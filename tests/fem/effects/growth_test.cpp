// A body that has grown evenly since its rest shape was taken.

#include <gtest/gtest.h>

#include "fem/effects/material/stiffening.h"
#include "fem/hyperelastic_body.h"
#include "tests/fem/beam.h"
#include "tests/fem/point_potentials.h"

namespace palpate::fem {
namespace {

constexpr double growth = 0.08;

BodySetting has_grown(MaterialLaw law, Effects effects = {}) {
    effects.growth.everywhere += growth;
    return {law, {.young = 0.7, .poisson = 0.4, .density = 0}, std::move(effects)};
}

struct GrowingBar {
    mesh::VolumeMesh mesh = jittered_bar(Kind::curved, {2, 1, 1}, {2, 1, 1});
    std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; });
    Eigen::VectorXd u = scatter(mesh.nodes.size(), 0.03), none = Eigen::VectorXd::Zero(u.size());

    /// Every node moved away from the origin in proportion to its distance.
    Eigen::VectorXd larger() const {
        Eigen::VectorXd result(mesh.nodes.size());
        for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i)
            result.segment<3>(3 * i) = growth * mesh.nodes.row(i).transpose();
        return result;
    }
};

TEST(Growth, LeavesNoForceInABodyThatIsFreeToTakeIt) {
    const GrowingBar bar;
    const auto stiffer = std::make_shared<Stiffening>(0.5, 2.0);
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body(bar.mesh, bar.held, dilatation);
        for (const MaterialLaw law : laws) {
            const BodySetting setting = has_grown(law, {.material = {stiffer}});
            const double confined = body.residual(bar.none, setting, bar.none).norm();
            EXPECT_GT(confined, 0.01);
            EXPECT_LT(body.residual(bar.larger(), setting, bar.none).norm(), 1e-13 * confined);  // rounding
        }
    }
}

/// Half of the bar has grown.
BodySetting has_grown_in_part(MaterialLaw law) {
    BodySetting setting{law, {.young = 0.7, .poisson = 0.4, .density = 0}, {}};
    setting.effects.growth.parts.push_back({{Vec3(2, 0.5, 0.5), 0.7}, 0.1});
    return setting;
}

TEST(Growth, OfAPartIsThatOfItsElements) {
    const GrowingBar bar;
    const HyperelasticBody body(bar.mesh, bar.held, dilatations.front());
    BodySetting plain{MaterialLaw::neo_hookean, {.young = 0.7, .poisson = 0.4, .density = 0}, {}};
    BodySetting everywhere = plain;
    everywhere.effects.growth.parts.push_back({{Vec3(0, 0, 0), 1e6}, growth});
    const Eigen::VectorXd r = body.residual(bar.u, has_grown(MaterialLaw::neo_hookean), bar.none);
    EXPECT_LT((body.residual(bar.u, everywhere, bar.none) - r).norm(), 1e-9 * r.norm());
    // A part that is nowhere near does nothing, and one that has grown pushes.
    BodySetting away = plain;
    away.effects.growth.parts.push_back({{Vec3(100, 0, 0), 1}, growth});
    EXPECT_EQ(body.residual(bar.none, away, bar.none).norm(), 0);
    EXPECT_GT(body.residual(bar.none, has_grown_in_part(MaterialLaw::neo_hookean), bar.none).norm(), 0.01);
}

TEST(Growth, IsSteppedAsALoadIs) {
    // At rest with all of it, Newton's method comes to no end.
    const mesh::VolumeMesh mesh = jittered_bar(Kind::curved, {6, 2, 2}, {6, 1, 1});
    const HyperelasticBody body(mesh, nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; }),
                                dilatations.front());
    BodySetting setting{MaterialLaw::neo_hookean, {.young = 0.7, .poisson = 0.45, .density = 0}, {}};
    setting.effects.growth.parts.push_back({{Vec3(3, 0.2, 0.5), 1}, 2});
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(mesh.nodes.size());
    const double confined = body.residual(none, setting, none).norm();
    const BodyEquilibrium found = body.equilibrium(setting, none);
    EXPECT_LT(found.residual, 1e-6 * confined);
    EXPECT_GT(found.u.cwiseAbs().maxCoeff(), 1);
}

TEST(Growth, ForceAndTangentAreDerivatives) {
    const GrowingBar bar;
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body(bar.mesh, bar.held, dilatation);
        for (const MaterialLaw law : laws) {
            BodySetting setting = has_grown(law, {.material = {std::make_shared<Stiffening>(0.5, 2.0)}});
            setting.effects.growth.add(has_grown_in_part(law).effects.growth);
            const auto energy = [&](const Eigen::VectorXd& at) {
                return Eigen::VectorXd::Constant(1, body.potential(at, setting, bar.none)).eval();
            };
            const auto force = [&](const Eigen::VectorXd& at) { return body.residual(at, setting, bar.none); };
            const Eigen::VectorXd r = force(bar.u);
            const Eigen::MatrixXd J = body.tangent(bar.u, setting);
            // Truncation h^2 and rounding 1e-16 / h, both times the energy's size; forces bend more.
            EXPECT_LT((differences(energy, bar.u, 1e-5).transpose() + r).norm(), 1e-8 * r.norm());
            EXPECT_LT((differences(force, bar.u, 1e-5) + J).norm(), 1e-7 * J.norm());
        }
    }
}

TEST(Growth, IsTheSameAsALargerBody) {
    // A body of rest shape g X, held in the same places, moves from there by u + X - g X.
    const GrowingBar bar;
    mesh::VolumeMesh larger = bar.mesh;
    larger.nodes *= 1 + growth;
    const HyperelasticBody body(bar.mesh, bar.held), other(larger, bar.held);
    const Eigen::VectorXd apart = bar.u - bar.larger();
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        const BodySetting plain{law, {.young = 0.7, .poisson = 0.4, .density = 0}, {}};
        EXPECT_NEAR(body.potential(bar.u, has_grown(law), bar.none), other.potential(apart, plain, bar.none), 1e-14);
        const Eigen::VectorXd r = other.residual(apart, plain, bar.none);
        EXPECT_LT((body.residual(bar.u, has_grown(law), bar.none) - r).norm(), 1e-13 * r.norm());  // rounding
    }
}

TEST(Growth, FlowsByWhatIsStrained) {
    const GrowingBar bar;
    const HyperelasticBody body(bar.mesh, bar.held);
    Effects yielding;
    yielding.plasticity = Plasticity{0.01, 0.1};
    for (const MaterialLaw law : laws) {
        const BodySetting setting = has_grown(law, yielding);
        const double confined = body.residual(bar.none, setting, bar.none).norm();
        const auto left_after = [&](const Eigen::VectorXd& u) {
            const auto flowed = body.state_after(u, setting, nullptr);
            return body.residual(bar.larger(), setting, bar.none, flowed.get()).norm();
        };
        EXPECT_LT(left_after(bar.larger()), 1e-13 * confined);  // rounding: it was strained by nothing
        EXPECT_GT(left_after(bar.larger() + 3 * bar.u), 0.01 * confined);
    }
}

}  // namespace
}  // namespace palpate::fem
