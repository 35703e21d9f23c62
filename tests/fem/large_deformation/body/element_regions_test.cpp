// A body of several materials.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fem/beam.h"

namespace palpate::fem {
namespace {

/// Two halves along the bar, or two layers across it: the region is where a coordinate of an element's centre is beyond
/// the middle.
ElementRegions beyond(const Beam& beam, int axis, double density = 1) {
    ElementRegions regions{.of_element = {}, .density = {density}};
    for (const auto& element : beam.mesh.tetrahedra.rowwise()) {
        double centre = 0;
        for (int c = 0; c < 4; ++c) centre += 0.25 * beam.mesh.nodes(element[c], axis);
        regions.of_element.push_back(centre > 0.5 * beam.size[axis] ? 0 : -1);
    }
    return regions;
}

TEST(ElementRegions, InSeriesAddTheirCompliances) {
    const Beam beam({40, 10, 10}, {4, 2, 2});
    const HyperelasticBody body(beam.mesh, beam.held, Dilatation::mean, beyond(beam, 0));
    // Without Poisson's ratio each half is in plain tension, the held face, too.
    BodySetting setting{MaterialLaw::linear, {.young = 2, .poisson = 0, .density = 0}, {}};
    setting.regions = {{.young = 0.5, .poisson = 0, .density = 0}};
    const double stress = 1e-3;
    const BodyEquilibrium found = body.equilibrium(setting, beam.end_force(Vec3(stress * 100, 0, 0)));
    EXPECT_NEAR(beam.tip(found.u).x(), stress * (20 / 2.0 + 20 / 0.5), 1e-7);  // Newton's tolerance
}

TEST(ElementRegions, InLayersAddTheirStiffnesses) {
    // Stretched evenly, the forces at the end are those of both layers.
    const Beam beam({40, 10, 10}, {4, 2, 2});
    const HyperelasticBody body(beam.mesh, beam.held, Dilatation::mean, beyond(beam, 2));
    BodySetting setting{MaterialLaw::linear, {.young = 2, .poisson = 0, .density = 0}, {}};
    setting.regions = {{.young = 0.5, .poisson = 0, .density = 0}};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    for (Eigen::Index i = 0; i < beam.mesh.nodes.rows(); ++i) u[3 * i] = 1e-3 * beam.mesh.nodes(i, 0);
    const Eigen::VectorXd internal = -body.residual(u, setting, Eigen::VectorXd::Zero(u.size()));
    double pull = 0;
    for (Eigen::Index i = 0; i < beam.mesh.nodes.rows(); ++i)
        if (beam.mesh.nodes(i, 0) > 40 - 1e-9) pull += internal[3 * i];
    EXPECT_NEAR(pull, 1e-3 * (50 * 2 + 50 * 0.5), 1e-12);
}

TEST(ElementRegions, OfOneMaterialChangeNothing) {
    const Beam beam({40, 10, 10}, {4, 2, 2});
    const HyperelasticBody plain = beam.body(), split(beam.mesh, beam.held, Dilatation::mean, beyond(beam, 2));
    const Eigen::VectorXd u = scatter(beam.mesh.nodes.size(), 0.05), none = Eigen::VectorXd::Zero(u.size());
    for (const MaterialLaw law : laws) {
        BodySetting setting{law, {.young = 0.7, .poisson = 0.4}, {}};
        const Eigen::VectorXd expected = plain.residual(u, setting, none);
        EXPECT_EQ(split.residual(u, setting, none), expected);  // without a material of its own a region has the body's
        setting.regions = {setting.material};
        EXPECT_EQ(split.residual(u, setting, none), expected);
    }
}

TEST(ElementRegions, ForcesAndTangentAreDerivatives) {
    const Beam beam({4, 2, 2}, {2, 1, 2});
    const Eigen::VectorXd u = scatter(beam.mesh.nodes.size(), 0.03), f = scatter(u.size(), 1e-3, 5);
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body(beam.mesh, beam.held, dilatation, beyond(beam, 2));
        for (const MaterialLaw law : laws) {
            BodySetting setting{law, {.young = 0.7, .poisson = 0.4}, {}};
            setting.regions = {{.young = 20, .poisson = 0.3}};
            const Eigen::VectorXd residual = body.residual(u, setting, f);
            const auto energy = [&](const Eigen::VectorXd& at) {
                return Eigen::VectorXd::Constant(1, body.potential(at, setting, f));
            };
            EXPECT_LT(relative(-differences(energy, u, 1e-5).transpose(), residual), 1e-6);
            const Eigen::VectorXd step = scatter(u.size(), 1, 7);
            const double h = 1e-6;
            const Eigen::VectorXd change =
                (body.residual(u - h * step, setting, f) - body.residual(u + h * step, setting, f)) / (2 * h);
            EXPECT_LT(relative(body.tangent(u, setting) * step, change), 1e-6);
            // The forces split by material and modulus.
            Eigen::Vector4d moduli(setting.material.shear_modulus(), setting.material.bulk_modulus(),
                                   setting.regions[0].shear_modulus(), setting.regions[0].bulk_modulus());
            const Eigen::VectorXd internal = f - residual;
            EXPECT_LT((body.modulus_forces(u, setting) * moduli - internal).norm(), 1e-13 * internal.norm());
        }
    }
}

TEST(ElementRegions, WeighWhatTheyAreMadeOf) {
    const Beam beam({40, 10, 10}, {4, 2, 2});
    const HyperelasticBody body(beam.mesh, beam.held, Dilatation::mean, beyond(beam, 2, 3.0));
    EXPECT_NEAR(body.points(ActsOn::material, 2e-9).weights.sum(), 2e-9 * (2000 + 3 * 2000), 1e-18);
}

TEST(ElementRegions, OfStrongContrastStandStill) {
    // A layer a million times as stiff bends as if there were no other, whichever of the two it is.
    const Beam beam({40, 10, 10}, {8, 2, 2});
    const HyperelasticBody body(beam.mesh, beam.held, Dilatation::mean, beyond(beam, 2));
    const auto tip = [&](double own, double region) {
        BodySetting setting{MaterialLaw::neo_hookean, {.young = own, .poisson = 0.3}, {}};
        setting.regions = {{.young = region, .poisson = 0.3}};
        // On the stiff layer's own edge: on the soft one it would press through.
        const double z = own > region ? 0 : beam.size.z();
        Eigen::VectorXd f = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
        for (Eigen::Index i = 0; i < beam.mesh.nodes.rows(); ++i)
            if (beam.mesh.nodes(i, 0) > 40 - 1e-9 && std::abs(beam.mesh.nodes(i, 2) - z) < 1e-9) f[3 * i + 2] = -1e-4;
        const Eigen::VectorXd u = body.equilibrium(setting, f).u;
        return u.dot(f);  // the load's work: how far the tip goes
    };
    constexpr double other = 1e-4;  // the soft layer bears some millionths
    EXPECT_LT(std::abs(tip(1e-6, 1) - tip(2e-6, 1)), other * tip(1e-6, 1));
    EXPECT_LT(std::abs(tip(1, 1e-6) - tip(1, 2e-6)), other * tip(1, 1e-6));
}

}  // namespace
}  // namespace palpate::fem
