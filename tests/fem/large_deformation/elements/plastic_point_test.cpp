// Yielding bodies: the return to the yield surface, its tangent, and bars and beams in closed form.

#include <cmath>

#include "fem/large_deformation/elements/plastic_point.h"
#include "fem/large_deformation/elements/point_law.h"
#include "mesh/errors.h"
#include "tests/fem/pulled_bar.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::HasSubstr;

using Flat = Eigen::Matrix<double, 9, 1>;
Flat flat(const Mat3& A) { return A.reshaped<Eigen::RowMajor>(); }
Mat3 square(const Eigen::VectorXd& a) { return a.reshaped<Eigen::RowMajor>(3, 3); }

constexpr Plasticity mild{.yield = 0.03, .hardening = 0.2};
const Mat3 sheared = (Mat3() << 1.1, 0.1, -0.05, 0.03, 0.95, 0.08, -0.1, 0.04, 1.02).finished();
const Mat3 sheared_on = Mat3::Identity() + 1.3 * (sheared - Mat3::Identity());
const Mat3 sheared_back = (Mat3() << 0.97, -0.02, 0.01, 0.02, 1.01, -0.06, 0.03, 0.02, 1.01).finished();

Mat3 stress(MaterialLaw law, const PlasticPoint& before, const Mat3& F, bool flows = true) {
    const Mat3 elastic = law == MaterialLaw::linear ? PointLaw<MaterialLaw::linear>(F).dD
                         : law == MaterialLaw::svk  ? PointLaw<MaterialLaw::svk>(F).dD
                                                    : PointLaw<MaterialLaw::neo_hookean>(F).dD;
    return elastic + plastic_terms(law, mild, before, F, flows, false).first;
}

TEST(PlasticPoint, ChangesNothingBelowTheYieldSurface) {
    const Mat3 little = Mat3::Identity() + 0.3 * (sheared - Mat3::Identity());
    for (const MaterialLaw law : laws) {
        EXPECT_GT(plastic_terms(law, mild, {}, sheared, true, false).first.norm(), 0.01);
        const MaterialTerms terms = plastic_terms(law, {.yield = 0.2, .hardening = 0}, {}, little, true, true);
        EXPECT_EQ(terms.w, 0);
        EXPECT_EQ(terms.first, Mat3::Zero());
        EXPECT_EQ(terms.second, MaterialTerms::Second::Zero());
        EXPECT_EQ(plastic_terms(law, mild, {}, sheared, false, false).first, Mat3::Zero());  // when told not to flow
    }
}

TEST(PlasticPoint, SecondIsTheDerivativesSymmetricPart) {
    for (const MaterialLaw law : laws) {
        const PlasticPoint used = plastic_point(law, mild, {}, sheared);
        EXPECT_GT(used.alpha, 0.01);
        for (const PlasticPoint& before : {PlasticPoint{}, used}) {
            for (const Mat3& F : {sheared_on, sheared_back}) {
                for (const bool flows : {true, false}) {
                    const auto first = [&](const Eigen::VectorXd& at) {
                        return flat(plastic_terms(law, mild, before, square(at), flows, false).first);
                    };
                    const Eigen::MatrixXd change = differences(first, flat(F), 1e-6);
                    const MaterialTerms::Second second = plastic_terms(law, mild, before, F, flows, true).second;
                    // Truncation h^2 and rounding 1e-16 / h.
                    EXPECT_LT(((change + change.transpose()) / 2 - second).norm(), 1e-8) << static_cast<int>(law);
                }
            }
        }
    }
}

TEST(PlasticPoint, EnergyIsAPotentialOrNearlyOne) {
    for (const MaterialLaw law : laws) {
        const PlasticPoint used = plastic_point(law, mild, {}, sheared);
        for (const PlasticPoint& before : {PlasticPoint{}, used}) {
            for (const Mat3& F : {sheared_on, sheared_back}) {
                const auto energy = [&](const Eigen::VectorXd& at) {
                    return Eigen::VectorXd::Constant(1, plastic_terms(law, mild, before, square(at), true, false).w)
                        .eval();
                };
                const Eigen::VectorXd change = differences(energy, flat(F), 1e-6).transpose();
                const Flat first = flat(plastic_terms(law, mild, before, F, true, false).first);
                // Exact for additive strains; in large strain but for their share of the stress.
                EXPECT_LT((change - first).norm(),
                          law == MaterialLaw::neo_hookean ? 0.2 * stress(law, before, F).norm() : 1e-8);
            }
        }
    }
}

TEST(PlasticPoint, StressStandsOnTheYieldSurfaceAfterwards) {
    for (const MaterialLaw law : laws) {
        const PlasticPoint after = plastic_point(law, mild, {}, sheared);
        // Standing there again changes nothing.
        const PlasticPoint again = plastic_point(law, mild, after, sheared);
        EXPECT_NEAR(again.alpha, after.alpha, 1e-14);
        EXPECT_LT((stress(law, {}, sheared) - stress(law, after, sheared)).norm(), 1e-14);
        EXPECT_LT((stress(law, {}, sheared) - stress(law, after, sheared, false)).norm(), 1e-14);
        // Mises' stress is that of the hardened material: 3 mu (yield + hardening alpha).
        const Mat3 P = stress(law, {}, sheared);
        const Mat3 tau = law == MaterialLaw::linear ? P
                         : law == MaterialLaw::svk  ? Mat3(sheared.inverse() * P)
                                                    : Mat3(P * sheared.transpose());
        EXPECT_NEAR(std::sqrt(1.5) * tau.norm(), 3 * (mild.yield + mild.hardening * after.alpha), 1e-14);
    }
}

TEST(PlasticPoint, TurnsWithTheBody) {
    const Mat3 R = Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        const PlasticPoint still = plastic_point(law, mild, {}, sheared),
                           turned = plastic_point(law, mild, {}, R * sheared);
        EXPECT_LT((still.set - turned.set).norm(), 1e-13);  // rounding
        EXPECT_NEAR(still.alpha, turned.alpha, 1e-14);
        EXPECT_LT((R * stress(law, still, sheared_back) - stress(law, still, R * sheared_back)).norm(), 1e-13);
    }
}

TEST(PlasticPoint, KeepsItsVolume) {
    PlasticPoint point;
    for (int k = 1; k <= 5; ++k) {
        point =
            plastic_point(MaterialLaw::neo_hookean, mild, point, Mat3::Identity() + k * (sheared - Mat3::Identity()));
        EXPECT_NEAR((Mat3::Identity() + point.set).determinant(), 1, 1e-13);  // rounding
    }
    EXPECT_GT(point.alpha, 0.1);
}

TEST(Plasticity, BarYieldsHardensAndStaysSet) {
    const Material material{.young = 0.5, .poisson = 0.3, .density = 0};
    const double mu = 0.5 / 2.6, E = 0.5;
    const Plasticity plasticity{.yield = 1e-5, .hardening = 0.25};
    const double yield_stress = 3 * mu * plasticity.yield, H = 3 * mu * plasticity.hardening;
    for (const MaterialLaw law : laws) {
        const PulledBar bar(law, material, {.plasticity = plasticity}, 1e-7);
        const auto strain = [&](const Eigen::VectorXd& u) { return bar.stretch(u).x() - 1; };
        // Strains are up to 1e-4: the laws part by that share of them or some times it, and springs take a millionth.
        const auto expect = [&](double found, double theory) { EXPECT_NEAR(found, theory, 1e-3 * std::abs(theory)); };
        expect(strain(bar.at(0.99 * yield_stress)), 0.99 * yield_stress / E);
        const double load = 2 * yield_stress, plastic = (load - yield_stress) / H;
        const Eigen::VectorXd u = bar.at(load);
        expect(strain(u), load / E + plastic);

        // Let go: the plastic strain stays, and volume is kept.
        const auto after = bar.body.state_after(u, bar.setting, nullptr);
        const Eigen::VectorXd set = bar.at(0, after.get(), &u);
        expect(strain(set), plastic);
        expect(bar.stretch(set).y() - 1, -plastic / 2);
        // Up to the same stress again it is elastic, beyond it flows on.
        expect(strain(bar.at(load, after.get(), &set)), strain(u));
        expect(strain(bar.at(1.5 * load, after.get(), &u)), 1.5 * load / E + (1.5 * load - yield_stress) / H);
    }
}

TEST(Plasticity, LargeStrainFollowsItsFlowRule) {
    // While a bar is pulled its elastic stretch s bears Kirchhoff's stress, mu (s^2 - 1/s) = 3 mu (yield + hardening
    // alpha), and the flow of alpha lengthens it by (s^3 + 2) / (2 s^3 + 1) of that, in logarithmic strain; this is
    // what stays when it is let go.
    const Material material{.young = 0.5, .poisson = 0.4, .density = 0};
    const double mu = 0.5 / 2.8, pull = 0.04;
    const Plasticity plasticity{.yield = 0.02, .hardening = 0.3};
    const PulledBar bar(MaterialLaw::neo_hookean, material, {.plasticity = plasticity}, 1e-5);
    std::shared_ptr<const MaterialState> state;
    Eigen::VectorXd u = Eigen::VectorXd::Zero(bar.beam.mesh.nodes.size());
    constexpr int steps = 40;
    for (int k = 1; k <= steps; ++k) {
        u = bar.at(pull * k / steps, state.get(), &u);
        state = bar.body.state_after(u, bar.setting, state.get());
    }
    const double tau = pull * bar.stretch(u).x(), alpha = (tau / (3 * mu) - plasticity.yield) / plasticity.hardening;
    double plastic = 0;
    constexpr int parts = 1000;
    for (int i = 0; i < parts; ++i) {
        const double bears = 3 * (plasticity.yield + plasticity.hardening * alpha * (i + 0.5) / parts);
        double s = 1 + bears / 3;
        for (int k = 0; k < 20; ++k) s -= (s * s - 1 / s - bears) / (2 * s + 1 / (s * s));
        plastic += alpha / parts * (s * s * s + 2) / (2 * s * s * s + 1);
    }
    const Eigen::Vector2d set = bar.stretch(bar.at(0, state.get(), &u));
    EXPECT_GT(plastic, 0.2);
    EXPECT_NEAR(std::log(set.x()), plastic, 0.01 * plastic);  // forty straight steps along a curved path
    EXPECT_NEAR(set.x() * set.y() * set.y(), 1, 1e-4);        // what the springs take
    // At once it is a tenth off, for which a user who needs more can put the load on in parts.
    const Eigen::VectorXd at_once = bar.at(pull);
    EXPECT_NEAR(bar.stretch(at_once).x() - 1, bar.stretch(u).x() - 1, 0.15 * (bar.stretch(u).x() - 1));
}

TEST(Plasticity, ForcesAreConsistent) {
    const auto mesh = jittered_bar(Kind::curved, {2, 1, 1}, {2, 1, 1});
    const std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; });
    const Eigen::VectorXd u = scatter(mesh.nodes.size(), 0.03), back = scatter(mesh.nodes.size(), 0.03, 9);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body(mesh, held, dilatation);
        for (const MaterialLaw law : laws) {
            BodySetting setting{law, {.young = 0.7, .poisson = 0.4, .density = 0}, {}};
            EXPECT_EQ(body.state_after(u, setting, nullptr), nullptr);
            const Eigen::VectorXd elastic = body.residual(u, setting, none);
            setting.effects.plasticity = mild;
            EXPECT_GT(relative(body.residual(u, setting, none), elastic), 0.1);
            const auto state = body.state_after(u, setting, nullptr);
            for (const MaterialState* before : {static_cast<const MaterialState*>(nullptr), state.get()}) {
                const auto force = [&](const Eigen::VectorXd& at) { return body.residual(at, setting, none, before); };
                const Eigen::MatrixXd J = body.tangent(back, setting, before), change = -differences(force, back, 1e-6);
                EXPECT_EQ(J, J.transpose());
                // Points that pass the yield surface in between would spoil it; there are none here.
                EXPECT_LT(((change + change.transpose()) / 2 - J).norm(), 1e-6 * J.norm()) << static_cast<int>(law);
                const Eigen::VectorXd internal = -force(back);
                const double mu = 0.7 / (2 * 1.4), K = 0.7 / (3 * 0.2);
                EXPECT_LT((body.modulus_forces(back, setting, before) * Eigen::Vector2d(mu, K) - internal).norm(),
                          1e-13 * internal.norm());  // rounding
                const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(mesh.tetrahedra.rows(), 1);
                EXPECT_LT((body.element_forces(back, setting, ones, before) - internal).norm(),
                          1e-13 * internal.norm());
            }
        }
    }
}

TEST(Plasticity, BeamBentFarFindsItsBalanceAndComesBackBent) {
    const Beam beam({20, 3, 3}, {10, 2, 2});
    const HyperelasticBody body = beam.body();
    BodySetting setting{MaterialLaw::neo_hookean, {.young = 0.1, .poisson = 0.4, .density = 0}, {}};
    setting.effects.plasticity = {.yield = 0.03, .hardening = 0.1};
    const Eigen::VectorXd f = beam.end_force({0, 0, -0.003}), none = Eigen::VectorXd::Zero(f.size());
    const auto unbalanced = [&](const Eigen::VectorXd& u, const Eigen::VectorXd& load, const MaterialState* before) {
        Eigen::VectorXd r = body.residual(u, setting, load, before);
        for (std::size_t i = 0; i < beam.held.size(); ++i) {
            if (beam.held[i]) r.segment<3>(3 * i).setZero();
        }
        return r.norm();
    };
    const Eigen::VectorXd u = body.equilibrium(setting, f).u;
    EXPECT_LT(unbalanced(u, f, nullptr), 1e-8 * f.norm());  // Newton's tolerance
    EXPECT_NEAR(beam.tip(u).z(), -15.1, 0.1);               // three quarters of its length; no theory knows it
    const auto state = body.state_after(u, setting, nullptr);
    const BodyEquilibrium released = body.equilibrium(setting, none, {}, &u, state.get());
    EXPECT_LT(unbalanced(released.u, none, state.get()), 1e-6 * f.norm());  // its tolerance is by residual stress
    EXPECT_NEAR(beam.tip(released.u).z(), -10.2, 0.1);                      // it springs back by a third
    // From a neighbour's answer it takes few steps.
    BodySetting stiffer = setting;
    stiffer.material.young *= 1.02;
    const BodyEquilibrium neighbour = body.equilibrium(stiffer, f, {}, &u);
    EXPECT_LT(neighbour.iterations, 12);
    EXPECT_LT(unbalanced(neighbour.u, f, nullptr), 0.1 * f.norm());
}

TEST(PlasticityInput, ValuesOutOfRangeAreNamed) {
    const Beam beam({2, 1, 1}, {2, 1, 1});
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    BodySetting setting{MaterialLaw::svk, {}, {}};
    setting.effects.plasticity = {.yield = 0, .hardening = 0};
    EXPECT_THAT(message_of<InvalidInput>([&] { beam.body().residual(none, setting, none); }),
                HasSubstr("first yield (stress over 3 mu) is 0"));
    setting.effects.plasticity = {.yield = 0.1, .hardening = -1};
    EXPECT_THAT(message_of<InvalidInput>([&] { beam.body().residual(none, setting, none); }),
                HasSubstr("hardening (over 3 mu) is -1"));
}

}  // namespace
}  // namespace palpate::fem
