// What effects in the material do to a body: their derivatives, and closed forms.

#include <Eigen/LU>
#include <cmath>

#include "fem/effects/local/stiffness_map.h"
#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "tests/fem/beam.h"
#include "tests/fem/point_potentials.h"

namespace palpate::fem {
namespace {

const Mat3 some_stress = (Mat3() << 0.2, 0.05, -0.1, 0.05, -0.3, 0.02, -0.1, 0.02, 0.1).finished();
const Mat3 some_gradient = (Mat3() << 1.2, 0.1, -0.05, 0.03, 0.85, 0.08, -0.1, 0.04, 1.12).finished();

std::shared_ptr<const MaterialEffect> stiffening() { return std::make_shared<Stiffening>(0.8, 3.0); }
std::shared_ptr<const MaterialEffect> fibres() {
    return std::make_shared<Anisotropy>(
        std::vector<Fibre>{{2.0, Vec3(1, 2, -1)}, {0.5, Vec3(0, 1, 3)}, {1.0, Vec3(1, 0, 0.5)}});
}
std::shared_ptr<const MaterialEffect> prestress() { return std::make_shared<Prestress>(some_stress); }
std::shared_ptr<const MaterialEffect> inclusion() {
    return std::make_shared<Inclusion>(Inclusion::sphere({1, 0.5, 0.5}, 0.6, 5.0));
}

const std::vector<std::shared_ptr<const MaterialEffect>> energies{stiffening(), fibres(), prestress()};

using Flat = Eigen::Matrix<double, 9, 1>;
Flat flat(const Mat3& A) { return A.reshaped<Eigen::RowMajor>(); }
Mat3 square(const Eigen::VectorXd& a) { return a.reshaped<Eigen::RowMajor>(3, 3); }

TEST(MaterialEffect, TermsAreDerivatives) {
    for (const auto& effect : energies) {
        const auto at = [&](const Eigen::VectorXd& F, bool with_second = false) {
            return effect->terms(Vec3::Zero(), square(F), with_second);
        };
        const Eigen::VectorXd F = flat(some_gradient);
        const auto energy = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd::Constant(1, at(x).w).eval(); };
        const auto stress = [&](const Eigen::VectorXd& x) { return flat(at(x).first); };
        const MaterialTerms terms = at(F, true);
        // Truncation h^2 and rounding 1e-16 / h.
        EXPECT_LT((differences(energy, F, 1e-5).transpose() - flat(terms.first)).norm(), 1e-8);
        EXPECT_LT((differences(stress, F, 1e-5) - terms.second).norm(), 1e-8 * terms.second.norm());
        EXPECT_GT(terms.first.norm(), 0.05);
    }
}

TEST(StiffnessMap, HasTheVarianceOfItsAmplitudesEverywhere) {
    Points places(3, 3);
    places << 0, 0, 0, 10, 0, 0, 0, 7, 2;
    for (const double length : {2.0, 8.0, 50.0}) {
        const StiffnessMap map(places, Eigen::Vector3d(0.3, -0.4, 0.9), length);
        // In between, next to a place, and so far off that all kernels underflow.
        for (const Vec3& X : {Vec3(4, 2, 1), Vec3(0.1, 0, 0), Vec3(1e4, 0, 0)}) {
            EXPECT_NEAR(map.weights(X).norm(), 1, 1e-12);
            EXPECT_NEAR(std::log(map.stiffness(X)), map.centred_weights(X).dot(Eigen::Vector3d(0.3, -0.4, 0.9)), 1e-12);
        }
    }
}

TEST(StiffnessMap, AveragesToOneOverItsPlaces) {
    Points places(2, 3);
    places << 0, 0, 0, 10, 0, 0;
    const StiffnessMap map(places, Eigen::Vector2d(1, -0.2), 4);
    EXPECT_NEAR(map.log_stiffness({0, 0, 0}) + map.log_stiffness({10, 0, 0}), 0, 1e-12);
    // Kernels of 1 and e = exp(-10^2 / (2 4^2)), over their norm: half of (1 - e) (1 + 0.2) / sqrt(1 + e^2) is on each
    // side.
    const double e = std::exp(-3.125);
    EXPECT_NEAR(map.log_stiffness({0, 0, 0}), 0.6 * (1 - e) / std::hypot(1, e), 1e-12);
}

TEST(MaterialEffect, TurnsWithTheBody) {
    const Mat3 R = Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    for (const auto& effect : energies) {
        const MaterialTerms still = effect->terms(Vec3::Zero(), some_gradient, false);
        const MaterialTerms turned = effect->terms(Vec3::Zero(), R * some_gradient, false);
        EXPECT_NEAR(turned.w, still.w, 1e-14);  // rounding
        EXPECT_LT((turned.first - R * still.first).norm(), 1e-14 * (1 + still.first.norm()));
    }
}

BodySetting with(MaterialLaw law, std::vector<std::shared_ptr<const MaterialEffect>> effects) {
    return {law, {.young = 0.7, .poisson = 0.4, .density = 0}, {.material = std::move(effects)}};
}

/// A small bar of curved elements in some displacement.
struct Bent {
    mesh::VolumeMesh mesh = jittered_bar(Kind::curved, {2, 1, 1}, {2, 1, 1});
    std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; });
    Eigen::VectorXd u = scatter(mesh.nodes.size(), 0.03), none = Eigen::VectorXd::Zero(u.size());
};

TEST(MaterialEffect, ForceAndTangentAreDerivativesUnderEveryLaw) {
    const Bent bar;
    auto all = energies;
    all.push_back(inclusion());
    all.push_back(std::make_shared<Inclusion>(Inclusion::box({0, 0, 0}, {1, 0.5, 2}, 0.3)));
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body(bar.mesh, bar.held, dilatation);
        for (const MaterialLaw law : laws) {
            for (const auto& effects : {all, {inclusion()}, {stiffening()}}) {
                const BodySetting setting = with(law, effects);
                const auto energy = [&](const Eigen::VectorXd& at) {
                    return Eigen::VectorXd::Constant(1, body.potential(at, setting, bar.none)).eval();
                };
                const auto force = [&](const Eigen::VectorXd& at) { return body.residual(at, setting, bar.none); };
                const Eigen::VectorXd r = force(bar.u);
                const Eigen::MatrixXd J = body.tangent(bar.u, setting);
                EXPECT_EQ(J, J.transpose());
                // Truncation h^2 and rounding 1e-16 / h, both times the energy's size; forces bend more.
                EXPECT_LT((differences(energy, bar.u, 1e-5).transpose() + r).norm(), 1e-8 * r.norm());
                EXPECT_LT((differences(force, bar.u, 1e-5) + J).norm(), 1e-7 * J.norm());
            }
        }
    }
}

TEST(MaterialEffect, ForcesSplitByModulusAndElement) {
    const Bent bar;
    const HyperelasticBody body(bar.mesh, bar.held);
    auto all = energies;
    all.push_back(inclusion());
    for (const MaterialLaw law : laws) {
        const BodySetting setting = with(law, all);
        const Eigen::VectorXd internal = -body.residual(bar.u, setting, bar.none);
        const double mu = 0.7 / (2 * 1.4), K = 0.7 / (3 * 0.2), tolerance = 1e-13 * internal.norm();  // rounding
        EXPECT_LT((body.modulus_forces(bar.u, setting) * Eigen::Vector2d(mu, K) - internal).norm(), tolerance);
        const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(bar.mesh.tetrahedra.rows(), 1);
        EXPECT_LT((body.element_forces(bar.u, setting, ones) - internal).norm(), tolerance);
    }
}

TEST(MaterialEffect, LinearLawTakesItToSecondOrder) {
    // So the force is affine in u, and the same as the others' as u goes to zero.
    const Bent bar;
    const HyperelasticBody body(bar.mesh, bar.held);
    const BodySetting linear = with(MaterialLaw::linear, energies), large = with(MaterialLaw::neo_hookean, energies);
    const auto force = [&](const BodySetting& setting, double share) {
        return body.residual(share * bar.u, setting, bar.none);
    };
    const Eigen::VectorXd rest = force(linear, 0), change = force(linear, 1) - rest;
    EXPECT_LT((force(linear, 3) - rest - 3 * change).norm(), 1e-13 * change.norm());  // rounding
    EXPECT_LT((force(large, 0) - rest).norm(), 1e-14);
    // Strains of 3e-7, the laws part by their squares.
    EXPECT_LT(relative(force(large, 1e-5) - rest, 1e-5 * change), 1e-4);
    EXPECT_GT(relative(force(large, 1) - rest, change), 0.02);
}

/// A free bar, pulled to a times its length along x: how wide it is, and the pull per area at rest, by an energy
/// density of the stretches along and across.
template <class Energy>
std::pair<double, double> uniaxial(double a, Energy&& energy) {
    const double h = 1e-5;
    double low = 0.5, high = 1.5;
    for (int k = 0; k < 60; ++k) {
        const double b = (low + high) / 2;
        (energy(a, b + h) > energy(a, b - h) ? high : low) = b;
    }
    return {low, (energy(a + h, low) - energy(a - h, low)) / (2 * h)};
}

/// The stretches along and across of a free bar of one material under a pull.
std::pair<double, double> stretches(const BodySetting& setting, double pull) {
    // Springs a millionth as stiff keep it from floating away.
    const Beam beam({3, 1, 1}, {3, 1, 1});
    BodySetting floating = setting;
    floating.effects.points = {std::make_shared<Springs>(ActsOn::support, 1e-7, 0.0)};
    const Eigen::VectorXd u = beam.body().equilibrium(floating, beam.pull(pull), {.tolerance = 1e-13}).u;
    Vec3 low = Vec3::Zero(), high = low;  // of the corners at 0 and at size
    for (Eigen::Index i = 0; i < beam.mesh.nodes.rows(); ++i) {
        const Vec3 X = beam.mesh.nodes.row(i);
        if (X.norm() < 1e-9) low = u.segment<3>(3 * i);
        if ((X - beam.size).norm() < 1e-9) high = u.segment<3>(3 * i);
    }
    const Vec3 F = Vec3::Ones() + (high - low).cwiseQuotient(beam.size);
    return {F.x(), (F.y() + F.z()) / 2};
}

const Material soft{.young = 0.5, .poisson = 0.4, .density = 0};
constexpr double mu = 0.5 / 2.8, K = 0.5 / 0.6;

double neo_hookean(double a, double b) {
    const double J = a * b * b;
    return mu / 2 * (std::pow(J, -2.0 / 3) * (a * a + 2 * b * b) - 3) + K / 2 * (J - 1) * (J - 1);
}

TEST(Stiffening, IsYeohsLaw) {
    // Pulled to a times its length, a body that keeps its volume bears 2 (a - 1/a^2) (C10 + 2 C20 x + 3 C30 x^2).
    const double c2 = 0.6, c3 = 2.0, a = 1.4, x = a * a + 2 / a - 3;
    const Material tight{.young = 0.5, .poisson = 0.49995, .density = 0};
    const double shear = tight.shear_modulus();
    const double pull = 2 * (a - 1 / (a * a)) * (shear / 2 + 2 * c2 * shear * x + 3 * c3 * shear * x * x);
    const BodySetting yeoh{MaterialLaw::neo_hookean, tight, {.material = {std::make_shared<Stiffening>(c2, c3)}}};
    const auto [along, across] = stretches(yeoh, pull);
    EXPECT_NEAR(along, a, 1e-3);  // stress over bulk modulus
    EXPECT_NEAR(across, 1 / std::sqrt(a), 1e-3);
}

TEST(Stiffening, StretchesABarAsItsEnergySays) {
    const double c2 = 0.6, c3 = 2.0, a = 1.3;
    const auto [b, pull] = uniaxial(a, [&](double along, double across) {
        const double x = std::pow(along * across * across, -2.0 / 3) * (along * along + 2 * across * across) - 3;
        return neo_hookean(along, across) + mu * (c2 * x * x + c3 * x * x * x);
    });
    const BodySetting setting{MaterialLaw::neo_hookean, soft, {.material = {std::make_shared<Stiffening>(c2, c3)}}};
    const auto [along, across] = stretches(setting, pull);
    EXPECT_NEAR(along, a, 1e-5);  // what the springs take and the differences miss
    EXPECT_NEAR(across, b, 1e-5);
}

TEST(Anisotropy, AddsItsModulusAlongTheFibre) {
    const double k = 3;
    const BodySetting setting{MaterialLaw::linear,
                              soft,
                              {.material = {std::make_shared<Anisotropy>(std::vector<Fibre>{{k, Vec3::UnitX()}})}}};
    // sigma = (E + k mu) strain along it, and Poisson's ratio is that of the rest; springs take a millionth.
    const auto [along, across] = stretches(setting, 0.01);
    EXPECT_NEAR((along - 1) * (soft.young + k * mu) / 0.01, 1, 1e-5);
    EXPECT_NEAR((across - 1) / (along - 1), -soft.poisson, 1e-5);

    // In large strain as its energy says.
    const double a = 1.3;
    const auto [b, pull] = uniaxial(a, [&](double length, double width) {
        return neo_hookean(length, width) + mu * k / 8 * (length * length - 1) * (length * length - 1);
    });
    BodySetting large = setting;
    large.law = MaterialLaw::neo_hookean;
    EXPECT_NEAR(stretches(large, pull).first, a, 1e-5);
    EXPECT_NEAR(stretches(large, pull).second, b, 1e-5);
}

TEST(Anisotropy, AcrossTheFibreTheMaterialIsAsSoftAsBefore) {
    // But for the fibre's share in contracting: the compliance is S - S n n n n S / (1 / (k mu) + n n S n n).
    const double k = 5, E = soft.young, nu = soft.poisson;
    const BodySetting setting{MaterialLaw::linear,
                              soft,
                              {.material = {std::make_shared<Anisotropy>(std::vector<Fibre>{{k, Vec3::UnitY()}})}}};
    const double expected = 0.01 * (1 / E - nu * nu / (E * E) / (1 / (k * mu) + 1 / E));
    EXPECT_NEAR((stretches(setting, 0.01).first - 1) / expected, 1, 1e-5);
}

TEST(Prestress, ShrinksAFreeBody) {
    // C:strain + mu S (I + strain) = 0, as S is held by the body as it stands. Alike in all directions:
    const double s = 0.02;
    const auto free = [&](MaterialLaw law, const Mat3& S) {
        return stretches({law, soft, {.material = {std::make_shared<Prestress>(S)}}}, 0);
    };
    const auto [all, width] = free(MaterialLaw::linear, s * Mat3::Identity());
    EXPECT_NEAR(all - 1, -mu * s / (3 * K + mu * s), 1e-8);  // what the springs take
    EXPECT_NEAR(width - 1, -mu * s / (3 * K + mu * s), 1e-8);
    // Along one, nu times that across:
    const auto [along, across] = free(MaterialLaw::linear, s * Vec3::UnitX() * Vec3::UnitX().transpose());
    EXPECT_NEAR(along - 1, -mu * s / (soft.young + mu * s), 1e-8);
    EXPECT_NEAR(across - 1, soft.poisson * mu * s / (soft.young + mu * s), 1e-8);

    // In large strain as its energy says.
    const double large = 0.5;
    const auto energy = [&](double length, double across_it) {
        return neo_hookean(length, across_it) + mu * large * (length * length - 1) / 2;
    };
    double low = 0.5, high = 1;
    for (int k = 0; k < 60; ++k) {
        const double a = (low + high) / 2;
        (uniaxial(a, energy).second > 0 ? high : low) = a;
    }
    EXPECT_NEAR(free(MaterialLaw::neo_hookean, large * Vec3::UnitX() * Vec3::UnitX().transpose()).first, low, 1e-5);
}

TEST(Inclusion, IsStiffWithinAndNotWithout) {
    const Inclusion ball = Inclusion::sphere({1, 2, 3}, 2, 8), box = Inclusion::box({0, 0, 0}, {1, 2, 4}, 0.25);
    EXPECT_DOUBLE_EQ(ball.stiffness({1, 2, 3}), 8);
    EXPECT_DOUBLE_EQ(ball.stiffness({1, 2 + 2 * 0.84, 3}), 8);
    EXPECT_NEAR(ball.stiffness({1, 2, 5}), std::sqrt(8), 1e-14);  // the middle of the border
    EXPECT_DOUBLE_EQ(ball.stiffness({1 + 2.31, 2, 3}), 1);
    EXPECT_DOUBLE_EQ(box.stiffness({0.8, -1.6, 3.3}), 0.25);
    EXPECT_NEAR(box.stiffness({0.1, 0.1, -4}), 0.5, 1e-14);
    EXPECT_DOUBLE_EQ(box.stiffness({0.1, 2.31, 0.1}), 1);
}

TEST(Inclusion, LiesInSeriesInABar) {
    // At nu = 0 a bar is a row of springs: elongation = sigma / E int dx / s(x).
    const Beam beam({20, 2, 2}, {80, 1, 1});
    const auto slice = std::make_shared<Inclusion>(Inclusion::box({10, 1, 1}, {4, 9, 9}, 6.0));
    const BodySetting setting{MaterialLaw::linear, {.young = 0.5, .poisson = 0, .density = 0}, {.material = {slice}}};
    const double sigma = 0.01;
    double compliance = 0;
    constexpr int parts = 20000;
    for (int i = 0; i < parts; ++i) compliance += 20.0 / parts / slice->stiffness({20 * (i + 0.5) / parts, 1, 1});
    const double tip = beam.tip(beam.body().equilibrium(setting, beam.end_force({4 * sigma, 0, 0})).u).x();
    // Four points an element see a border five elements wide, whose ends are kinks.
    EXPECT_NEAR(tip, sigma / 0.5 * compliance, 1e-3 * tip);
}

}  // namespace
}  // namespace palpate::fem
