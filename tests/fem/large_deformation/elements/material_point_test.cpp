// Bodies that are softer after their first large strain: the law, its tangent, and what a bar goes through.

#include "fem/large_deformation/elements/material_point.h"

#include <cmath>
#include <numbers>

#include "fem/effects/material/damage.h"
#include "fem/effects/material/stiffening.h"
#include "mesh/errors.h"
#include "tests/fem/pulled_bar.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::HasSubstr;

constexpr Damage damaged{.share = 0.6, .strain = 0.1};
constexpr Plasticity yielding{.yield = 0.06, .hardening = 0.2};
const Mat3 strained = (Mat3() << 1.1, 0.1, -0.05, 0.03, 0.95, 0.08, -0.1, 0.04, 1.02).finished();

/// So many times as far from rest.
Mat3 share_of(double share) { return Mat3::Identity() + share * (strained - Mat3::Identity()); }

Mat3 as_square(const Eigen::VectorXd& a) { return a.reshaped<Eigen::RowMajor>(3, 3); }
Eigen::VectorXd as_rows(const Mat3& A) { return A.reshaped<Eigen::RowMajor>(); }

TEST(Damage, LeavesTheFirstCurveAsItIs) {
    for (const double D : {0.0, 0.003, 0.2}) {
        const DamageTerms terms = damage_energy(damaged, 0.003, std::max(D, 0.003));
        EXPECT_EQ(terms.first, 0);
        EXPECT_EQ(terms.second, 0);
    }
}

TEST(Damage, TermsAreDerivatives) {
    constexpr double most = 0.02, h = 1e-6;
    for (const double D : {0.0, 0.004, 0.015, 0.0199}) {
        const DamageTerms at = damage_energy(damaged, most, D), up = damage_energy(damaged, most, D + h),
                          down = damage_energy(damaged, most, D - h), beyond = damage_energy(damaged, most + h, D),
                          within = damage_energy(damaged, most - h, D);
        // Truncation: h^2 / m^2 with m = 0.015.
        EXPECT_NEAR((up.energy - down.energy) / (2 * h), at.first, 1e-8);
        EXPECT_NEAR((up.first - down.first) / (2 * h), at.second, 1e-6 * at.second);
        EXPECT_NEAR((beyond.first - within.first) / (2 * h), -at.second, 1e-6 * at.second);
    }
}

TEST(Damage, TakesItsShareOfAPointThatBoreMuch) {
    const double m = 1.5 * damaged.strain * damaged.strain;
    EXPECT_DOUBLE_EQ(damage_energy(damaged, m, 0).first, -damaged.share * std::erf(1.0));
    EXPECT_NEAR(damage_energy(damaged, 100 * m, 0).first, -damaged.share, 1e-15);
    EXPECT_EQ(damage_energy(damaged, m, 0).energy, 0);  // no energy at rest
}

TEST(MaterialPoint, DamageHasAPotentialAndItsTangent) {
    for (const MaterialLaw law : laws) {
        const MaterialPoint used = material_point(law, {}, damaged, {}, strained);
        for (const double share : {0.3, 0.9, 1.4}) {
            const auto terms = [&](const Mat3& F, bool with_second) {
                return damage_terms(law, damaged, used.most, F, {}, with_second);
            };
            const auto energy = [&](const Eigen::VectorXd& at) {
                return Eigen::VectorXd::Constant(1, terms(as_square(at), false).w).eval();
            };
            const auto first = [&](const Eigen::VectorXd& at) { return as_rows(terms(as_square(at), false).first); };
            const MaterialTerms here = terms(share_of(share), true);
            // Truncation h^2 and rounding 1e-16 / h.
            const Eigen::VectorXd F = as_rows(share_of(share));
            EXPECT_LT((differences(energy, F, 1e-6).transpose() - as_rows(here.first)).norm(), 1e-9);
            EXPECT_LT((differences(first, F, 1e-6) - here.second).norm(), 1e-7) << static_cast<int>(law);
            EXPECT_LT((here.second - here.second.transpose()).norm(), 1e-14);  // rounding
            EXPECT_EQ(here.first.isZero(0), share > 1);  // strained further than ever it is as without damage
        }
    }
}

TEST(MaterialPoint, DamageIsThatOfElasticStrain) {
    for (const MaterialLaw law : laws) {
        const MaterialPoint flowed = material_point(law, yielding, damaged, {}, strained);
        EXPECT_GT(flowed.plastic.alpha, 0.01);
        // Less than the law's own energy there: the rest has flowed. Standing there again is nothing new.
        EXPECT_LT(flowed.most, 0.9 * material_point(law, {}, damaged, {}, strained).most);
        EXPECT_NEAR(material_point(law, yielding, damaged, flowed, strained).most, flowed.most, 1e-14);
        EXPECT_EQ(material_point(law, yielding, damaged, flowed, share_of(0.8)).most, flowed.most);
        // Where it flowed to it stands on its first curve.
        const MaterialTerms flow = plastic_terms(law, yielding, flowed.plastic, strained, false, false);
        EXPECT_LT(damage_terms(law, damaged, flowed.most, strained, flow, false).first.norm(), 1e-7);
        const Mat3 back = share_of(0.8);
        const MaterialTerms then = plastic_terms(law, yielding, flowed.plastic, back, false, true);
        const auto first = [&](const Eigen::VectorXd& at) {
            const Mat3 F = as_square(at);
            return as_rows(damage_terms(law, damaged, flowed.most, F,
                                        plastic_terms(law, yielding, flowed.plastic, F, false, false), false)
                               .first);
        };
        const MaterialTerms terms = damage_terms(law, damaged, flowed.most, back, then, true);
        EXPECT_LT((differences(first, as_rows(back), 1e-6) - terms.second).norm(), 1e-7);
    }
}

TEST(MaterialPoint, TurnsWithTheBody) {
    const Mat3 R = Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        EXPECT_NEAR(material_point(law, {}, damaged, {}, R * strained).most,
                    material_point(law, {}, damaged, {}, strained).most, 1e-14);
    }
}

// A bar that is pulled by a stress, let go, and pulled again.

const Material rubber{.young = 0.5, .poisson = 0.4, .density = 0};

TEST(DamagedBar, FollowsItsClosedFormInSmallStrain) {
    // Mises stress sigma bears a distortion of sigma^2 / (6 (eta mu)^2), and the volume answers to K as before.
    const Damage damage{.share = 0.5, .strain = 2e-3};
    const double mu = rubber.shear_modulus(), K = rubber.bulk_modulus(), peak = 1e-3;
    const double most = std::pow(peak / mu, 2) / 6;
    const auto strain_at = [&](double sigma) {
        double eta = 1;
        for (int k = 0; k < 100; ++k) eta = 1 + damage_energy(damage, most, std::pow(sigma / (eta * mu), 2) / 6).first;
        return sigma / (9 * K) + sigma / (3 * eta * mu);
    };
    for (const MaterialLaw law : laws) {
        const PulledBar bar(law, rubber, {.damage = damage}, 1e-6);
        const auto strain = [&](const Eigen::VectorXd& u) { return bar.stretch(u).x() - 1; };
        // Strains are up to 2e-3: the laws part by 1.5 times that share of them.
        const auto expect = [&](double found, double theory) { EXPECT_NEAR(found, theory, 3.2e-3 * theory); };
        const Eigen::VectorXd u = bar.at(peak);
        expect(strain(u), peak / rubber.young);
        const auto after = bar.body.state_after(u, bar.setting, nullptr);
        for (const double share : {0.25, 0.6, 0.9}) {
            expect(strain(bar.at(share * peak, after.get(), &u)), strain_at(share * peak));
            EXPECT_GT(strain_at(share * peak), 1.02 * share * peak / rubber.young);
        }
        EXPECT_NEAR(strain(bar.at(0, after.get(), &u)), 0, 1e-10);  // nothing stays
    }
}

TEST(DamagedBar, LosesWorkOverACycleAndOnlyOnce) {
    const Damage damage{.share = 0.6, .strain = 0.08};
    const double peak = 0.06;
    for (const MaterialLaw law : laws) {
        const PulledBar bar(law, rubber, {.damage = damage}, 1e-6);
        const PulledBar elastic(law, rubber, {}, 1e-6);
        std::shared_ptr<const MaterialState> state;
        Eigen::VectorXd u = Eigen::VectorXd::Zero(bar.beam.mesh.nodes.size());
        constexpr int steps = 20;
        std::vector<double> first(steps + 1), back(steps + 1), again(steps + 1);  // stretches
        const auto go = [&](int k) {
            u = bar.at(peak * k / steps, state.get(), &u);
            state = bar.body.state_after(u, bar.setting, state.get());
            return bar.stretch(u).x();
        };
        for (int k = 0; k <= steps; ++k) first[k] = go(k);
        const double across = bar.stretch(u).y();
        for (int k = steps; k >= 0; --k) back[k] = go(k);
        for (int k = 0; k <= steps; ++k) again[k] = go(k);
        for (int k = 0; k <= steps; ++k) {
            EXPECT_NEAR(first[k], elastic.stretch(elastic.at(peak * k / steps)).x(), 1e-7);  // Newton's tolerance
            EXPECT_NEAR(again[k], back[k], 1e-7);
            const bool is_between = k > 0 && k < steps;
            EXPECT_GE(back[k], first[k] + (is_between ? 1e-3 : -1e-6));
        }
        EXPECT_NEAR(again[steps], first[steps], 1e-6);
        // Work by the trapezoidal rule over stresses, for the bar's volume of 3: int F dx = [F x] - int x dF.
        const auto given_back = [&](const std::vector<double>& stretch) {
            double sum = 0;
            for (int k = 0; k < steps; ++k) sum += 0.5 * (stretch[k] + stretch[k + 1]) * peak / steps;
            return peak * stretch[steps] - sum;
        };
        const double lost = given_back(first) - given_back(back);
        const Vec3 stretches(first[steps], across, across);
        const double most = material_point(law, {}, damage, {}, stretches.asDiagonal()).most;
        const double m = 1.5 * damage.strain * damage.strain, x = most / m;
        const double theory = damage.share * m * rubber.shear_modulus() *
                              (x * std::erf(x) + std::expm1(-x * x) * std::numbers::inv_sqrtpi);
        EXPECT_GT(lost, 1e-4);
        EXPECT_NEAR(lost, theory, 0.003 * theory);  // trapezia
        // Beyond the greatest strain so far it goes on along the first curve.
        const double further = bar.stretch(bar.at(1.3 * peak, state.get(), &u)).x();
        EXPECT_NEAR(further, elastic.stretch(elastic.at(1.3 * peak)).x(), 1e-6);
    }
}

TEST(DamagedBar, ForcesAreConsistent) {
    const auto mesh = jittered_bar(Kind::curved, {2, 1, 1}, {2, 1, 1});
    const std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; });
    const Eigen::VectorXd u = scatter(mesh.nodes.size(), 0.05), back = scatter(mesh.nodes.size(), 0.02, 9);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body(mesh, held, dilatation);
        for (const MaterialLaw law : laws) {
            BodySetting setting{law, {.young = 0.7, .poisson = 0.4, .density = 0}, {}};
            setting.effects.material = {std::make_shared<Stiffening>(0.5, 2.0)};
            const Eigen::VectorXd elastic = body.residual(back, setting, none);
            setting.effects.damage = damaged;
            EXPECT_EQ(relative(body.residual(back, setting, none), elastic), 0);  // strained for the first time
            const auto state = body.state_after(u, setting, nullptr);
            EXPECT_GT(relative(body.residual(back, setting, none, state.get()), elastic), 0.05);
            const auto energy = [&](const Eigen::VectorXd& at) {
                return Eigen::VectorXd::Constant(1, body.potential(at, setting, none, state.get())).eval();
            };
            const auto force = [&](const Eigen::VectorXd& at) { return body.residual(at, setting, none, state.get()); };
            const Eigen::VectorXd r = force(back);
            const Eigen::MatrixXd J = body.tangent(back, setting, state.get());
            EXPECT_EQ(J, J.transpose());
            // Truncation h^2 and rounding 1e-16 / h, both times the energy's size.
            EXPECT_LT((differences(energy, back, 1e-6).transpose() + r).norm(), 1e-7 * r.norm());
            EXPECT_LT((differences(force, back, 1e-6) + J).norm(), 1e-6 * J.norm()) << static_cast<int>(law);
            const double mu = 0.7 / (2 * 1.4), K = 0.7 / (3 * 0.2);
            EXPECT_LT((body.modulus_forces(back, setting, state.get()) * Eigen::Vector2d(mu, K) + r).norm(),
                      1e-13 * r.norm());  // rounding
        }
    }
}

TEST(DamagedBeam, FindsItsBalanceAfterAnotherLoad) {
    const Beam beam({20, 3, 3}, {10, 2, 2});
    const HyperelasticBody body = beam.body();
    BodySetting setting{MaterialLaw::neo_hookean, {.young = 0.1, .poisson = 0.45, .density = 0}, {}};
    const Eigen::VectorXd down = beam.end_force({0, 0, -0.003}), half = 0.5 * down,
                          aside = beam.end_force({0, 0.001, 0});
    const double elastic = beam.tip(body.equilibrium(setting, half).u).z();
    setting.effects.damage = Damage{.share = 0.8, .strain = 0.05};
    const Eigen::VectorXd u = body.equilibrium(setting, down).u;
    const auto state = body.state_after(u, setting, nullptr);
    const BodyEquilibrium less = body.equilibrium(setting, half, {}, &u, state.get());
    EXPECT_LT(beam.tip(less.u).z(), 1.1 * elastic);
    EXPECT_LT(less.iterations, 25);
    // And from rest, where it bends aside.
    const BodyEquilibrium bent = body.equilibrium(setting, aside, {}, nullptr, state.get());
    EXPECT_GT(beam.tip(bent.u).y(), 1.1 * beam.tip(body.equilibrium(setting, aside).u).y());
}

TEST(DamageInput, ValuesOutOfRangeAreNamed) {
    const Beam beam({2, 1, 1}, {2, 1, 1});
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    BodySetting setting{MaterialLaw::svk, {}, {}};
    setting.effects.damage = Damage{.share = 1, .strain = 0.1};
    EXPECT_THAT(message_of<InvalidInput>([&] { beam.body().residual(none, setting, none); }),
                HasSubstr("share of stress that it may take is 1; allowed: less than 1"));
    setting.effects.damage = Damage{.share = 0.5, .strain = 0};
    EXPECT_THAT(message_of<InvalidInput>([&] { beam.body().residual(none, setting, none); }),
                HasSubstr("the strain that does it is 0"));
}

}  // namespace
}  // namespace palpate::fem
