// Energies of the skin's area: their derivatives, the area that tension costs, and a ball and a shell in closed form.

#include <Eigen/LU>
#include <cmath>

#include "fem/effects/surface/facet.h"
#include "fem/elements/shape.h"
#include "tests/fem/beam.h"
#include "tests/fem/hollow.h"
#include "tests/fem/point_potentials.h"
#include "tests/surface_energies.h"

namespace palpate::fem {
namespace {

const Material skinned{.young = 0.7, .poisson = 0.4, .density = 0};

/// A triangle at rest and deformed, with 3 or 6 nodes.
template <int nodes>
void check_facet() {
    FacetNodes<nodes> X = FacetNodes<nodes>::Zero();
    X.col(1) = Vec3(2, 0, 0.1);
    X.col(2) = Vec3(0.3, 1.5, 0);
    for (int k = 3; k < nodes; ++k) {
        const auto [a, b] = edge_corners[k - 3];
        X.col(k) = (X.col(a) + X.col(b)) / 2 + Vec3(0, 0, 0.05 * k);
    }
    const Vec3 l(0.5, 0.2, 0.3);
    const auto point = facet_point<nodes>(X, shape<3, nodes>(l), shape_gradient<3, nodes>(l), 1);
    const SurfaceEnergies effects{std::make_shared<Tension>(0.3), std::make_shared<AreaSpring>(0.5)};
    const auto at = [&](const Eigen::VectorXd& x) {
        return FacetEnergy<nodes>(effects, point, FacetNodes<nodes>(x.reshaped(3, nodes)));
    };
    const auto value = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd::Constant(1, at(x).value()).eval(); };
    const auto gradient = [&](const Eigen::VectorXd& x) {
        Eigen::VectorXd g(3 * nodes);
        for (int i = 0; i < nodes; ++i) g.segment<3>(3 * i) = at(x).by_node(i);
        return g;
    };
    const Eigen::VectorXd x = X.reshaped() + scatter(3 * nodes, 0.2);
    Eigen::MatrixXd H(3 * nodes, 3 * nodes);
    for (int i = 0; i < nodes; ++i) {
        for (int j = 0; j < nodes; ++j) H.block<3, 3>(3 * i, 3 * j) = at(x).by_nodes(i, j);
    }
    // Truncation h^2, rounding 1e-16 / h.
    EXPECT_LT((differences(value, x, 1e-5).transpose() - gradient(x)).norm(), 1e-9);
    EXPECT_LT((differences(gradient, x, 1e-5) - H).norm(), 1e-8);
    EXPECT_LT((H - H.transpose()).norm(), 1e-14);
}

TEST(SurfaceEnergy, OfALinearFacetHasItsDerivatives) { check_facet<3>(); }

TEST(SurfaceEnergy, OfAQuadraticFacetHasItsDerivatives) { check_facet<6>(); }

/// A small hollow bar, held at one end.
struct HollowBar {
    mesh::VolumeMesh mesh = hollow_bar({3, 3, 3}, {3, 3, 3}, {{1, 1, 1}});
    HyperelasticBody body{mesh, nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; })};
    Eigen::VectorXd none = Eigen::VectorXd::Zero(mesh.nodes.size());
};

TEST(SurfaceEnergy, TensionCostsTheArea) {
    const HollowBar bar;
    const double gamma = 0.02;
    const Mat3 F = (Mat3() << 1.2, 0.1, -0.05, 0.03, 0.85, 0.08, -0.1, 0.04, 1.12).finished();
    const Eigen::VectorXd u = nodal(bar.mesh, [&](const Vec3& x) { return Vec3(F * x - x); });
    double area = 0;
    for (Eigen::Index f = 0; f < bar.mesh.faces.rows(); ++f) {
        const Points corners = bar.mesh.nodes(bar.mesh.faces.row(f), Eigen::all);
        const Vec3 a = corners.row(1) - corners.row(0), b = corners.row(2) - corners.row(0);
        area += (F * a).cross(F * b).norm() / 2;
    }
    const BodySetting off{MaterialLaw::neo_hookean, skinned, {}};
    const BodySetting on{MaterialLaw::neo_hookean, skinned, {.surface = {std::make_shared<Tension>(gamma)}}};
    const double cost = bar.body.potential(u, on, bar.none) - bar.body.potential(u, off, bar.none);
    EXPECT_NEAR(cost, gamma * area, 1e-13);  // rounding, of the body's own energy of some 1 N mm too
}

TEST(SurfaceEnergy, ForceAndTangentAreDerivatives) {
    // Of what it does: with and without. Directions are drawn, as there are many nodes.
    const HollowBar bar;
    const Eigen::VectorXd at = scatter(bar.none.size(), 0.05);
    for (const MaterialLaw law : laws) {
        const BodySetting off{law, skinned, {}};
        const BodySetting on{
            law, skinned, {.surface = {std::make_shared<Tension>(0.02), std::make_shared<AreaSpring>(0.03)}}};
        const auto energy = [&](const Eigen::VectorXd& u) {
            return bar.body.potential(u, on, bar.none) - bar.body.potential(u, off, bar.none);
        };
        const auto push = [&](const Eigen::VectorXd& u) -> Eigen::VectorXd {
            return bar.body.residual(u, on, bar.none) - bar.body.residual(u, off, bar.none);
        };
        const Eigen::SparseMatrix<double> J = bar.body.tangent(at, on) - bar.body.tangent(at, off);
        const Eigen::SparseMatrix<double> mirrored = J.transpose();
        EXPECT_LT((J - mirrored).norm(), 1e-13 * J.norm());  // rounding
        for (unsigned seed = 0; seed < 5; ++seed) {
            const Eigen::VectorXd along = scatter(at.size(), 1, seed);
            constexpr double h = 1e-5;
            const Eigen::VectorXd ahead = at + h * along, behind = at - h * along;
            // Truncation h^2 and rounding 1e-16 / h.
            EXPECT_NEAR((energy(ahead) - energy(behind)) / (2 * h), -push(at).dot(along), 1e-8);
            EXPECT_LT(((push(behind) - push(ahead)) / (2 * h) - J * along).norm(), 1e-8);
        }
        // What pulls on itself pushes the body nowhere.
        const Eigen::VectorXd f = push(at);
        EXPECT_LT(f.reshaped(3, f.size() / 3).rowwise().sum().norm(), 1e-13);
        EXPECT_GT(f.norm(), 0.01);
    }
}

/// How far nodes at radius r move out in the mean, under tension. Springs a hundred-thousandth as stiff, all over the
/// outside, keep the body from floating away.
double radial_motion(const mesh::VolumeMesh& mesh, MaterialLaw law, double outside, double gamma, double r) {
    const HyperelasticBody body(mesh, nodes_where(mesh, [&](const Vec3& x) { return x.norm() > outside - 1e-9; }));
    const BodySetting setting{law,
                              skinned,
                              {.points = {std::make_shared<Springs>(ActsOn::support, 1e-5, 0.0)},
                               .surface = {std::make_shared<Tension>(gamma)}}};
    const Eigen::VectorXd u = body.equilibrium(setting, Eigen::VectorXd::Zero(mesh.nodes.size())).u;
    double sum = 0;
    int count = 0;
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
        const Vec3 X = mesh.nodes.row(i);
        if (std::abs(X.norm() - r) > 1e-9) continue;
        sum += u.segment<3>(3 * i).dot(X.normalized());
        ++count;
    }
    return sum / count;
}

constexpr double bulk_of_skinned = 0.7 / (3 * (1 - 2 * 0.4));  // of the material

TEST(SurfaceEnergy, TensionPressesOnABallAsLaplaceSays) {
    // 2 gamma / R all round: u(R) = -2 gamma / (3 K) [Laplace 1806]
    const double R = 2, gamma = 1e-3;
    const auto error = [&](int cuts) {
        const double found = radial_motion(ball(R, 3, cuts), MaterialLaw::linear, R, gamma, R);
        return std::abs(found / (-2 * gamma / (3 * bulk_of_skinned)) - 1);
    };
    const double coarse = error(1), fine = error(2);  // facets 45 and 22 degrees wide
    EXPECT_LT(fine, 0.015);
    EXPECT_LT(fine, coarse / 6);  // of third order nearly
}

TEST(SurfaceEnergy, TensionShrinksABallUntilItsBulkBearsIt) {
    // In large deformation K (1 - L^3) = 2 gamma / (L R), L how long radii become.
    const double R = 2, gamma = 0.4;
    double L = 1;
    for (int k = 0; k < 200; ++k)
        L = std::cbrt(1 - 2 * gamma / (L * R) / bulk_of_skinned);  // a contraction: slope 0.16
    EXPECT_LT(L, 0.9);
    EXPECT_NEAR(radial_motion(ball(R, 3, 2), MaterialLaw::neo_hookean, R, gamma, R) / (R * (L - 1)), 1,
                0.002);  // facets
}

TEST(SurfaceEnergy, TensionPressesOnAShellAsLaplaceSays) {
    // Pressures 2 gamma / r: inwards on the outside, and into the cavity on the inside. Between them [Lame 1852]
    //   u(r) = A r + B / r^2,  stress(r) = E A / (1 - 2 nu) - 2 E B / ((1 + nu) r^3),
    // -2 gamma / b outside, 2 gamma / a inside.
    const double a = 1, b = 2, gamma = 1e-4, E = skinned.young, nu = skinned.poisson;
    const double outside = -2 * gamma / b, inside = 2 * gamma / a;
    const double B = (outside - inside) * (1 + nu) / (2 * E) / (1 / (a * a * a) - 1 / (b * b * b));
    const double A = (outside + 2 * E * B / ((1 + nu) * b * b * b)) * (1 - 2 * nu) / E;
    for (const double r : {a, b}) {
        const double found = radial_motion(spherical_shell(a, b, 4, 2), MaterialLaw::linear, b, gamma, r);
        EXPECT_NEAR(found / (A * r + B / (r * r)), 1, 0.003) << r;  // four layers of elements
    }
}

}  // namespace
}  // namespace palpate::fem
