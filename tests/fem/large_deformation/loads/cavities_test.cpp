// Pressure in closed cavities: their volume, its derivatives, and hollow spheres in closed form.

#include <Eigen/LU>
#include <cmath>

#include "tests/fem/beam.h"
#include "tests/fem/hollow.h"
#include "tests/fem/point_potentials.h"

namespace palpate::fem {
namespace {

/// Held at one element.
HyperelasticBody body_of(const mesh::VolumeMesh& mesh) {
    std::vector<char> held(mesh.nodes.rows(), 0);
    for (int k = 0; k < 10; ++k) held[mesh.tetrahedra(0, k)] = 1;
    return {mesh, held};
}

TEST(Cavities, AreWhatIsEnclosed) {
    EXPECT_FALSE(Beam({2, 1, 1}, {2, 1, 1}).body().has_cavities());
    EXPECT_EQ(Beam({2, 1, 1}, {2, 1, 1}).body().cavity_volume(Eigen::VectorXd::Zero(3)), 0);
    // A hole to the outside is none.
    EXPECT_FALSE(body_of(hollow_bar({3, 3, 3}, {3, 3, 3}, {{1, 1, 1}, {1, 1, 2}})).has_cavities());
    EXPECT_FALSE(body_of(hollow_bar({3, 3, 3}, {3, 3, 3}, {{1, 1, 0}, {1, 1, 1}, {1, 1, 2}})).has_cavities());

    const auto mesh = hollow_bar({10, 3, 3}, {5, 3, 3}, {{1, 1, 1}, {3, 1, 1}});
    const HyperelasticBody two = body_of(mesh);
    EXPECT_TRUE(two.has_cavities());
    EXPECT_NEAR(two.cavity_volume(Eigen::VectorXd::Zero(mesh.nodes.size())), 4, 1e-14);  // rounding
    // They grow with the body that they are in.
    const Mat3 G = (Mat3() << 0.2, 0.1, -0.05, 0.03, -0.15, 0.08, -0.1, 0.04, 0.12).finished();
    const Eigen::VectorXd u = nodal(mesh, [&](const Vec3& x) { return Vec3(G * x + Vec3(100, 0, -20)); });
    EXPECT_NEAR(two.cavity_volume(u), 4 * (Mat3::Identity() + G).determinant(), 1e-11);  // rounding of the shift
}

TEST(Cavities, CurvedOnesAreExact) {
    // Quadratic elements bow as this field does, and what the cavity becomes is the integral of J over it. J is cubic,
    // which Simpson's rule takes exactly.
    const auto mesh = hollow_bar({3, 3, 3}, {3, 3, 3}, {{1, 1, 1}});
    const auto bow = [](const Vec3& x) { return Vec3(0.1 * x.y() * x.z(), 0.05 * x.x() * x.x(), 0.1 * x.x() * x.y()); };
    constexpr std::array simpson{std::pair(1.0, 1.0 / 6), std::pair(1.5, 4.0 / 6), std::pair(2.0, 1.0 / 6)};
    double volume = 0;
    for (const auto& [x, wx] : simpson) {
        for (const auto& [y, wy] : simpson) {
            for (const auto& [z, wz] : simpson) {
                Mat3 F = Mat3::Identity();
                F.row(0) += Vec3(0, 0.1 * z, 0.1 * y);
                F.row(1) += Vec3(0.1 * x, 0, 0);
                F.row(2) += Vec3(0.1 * y, 0.1 * x, 0);
                volume += wx * wy * wz * F.determinant();
            }
        }
    }
    EXPECT_NEAR(body_of(mesh).cavity_volume(nodal(mesh, bow)), volume, 1e-14);  // rounding
    EXPECT_GT(std::abs(volume - 1), 0.04);
}

/// A small hollow bar in some displacement.
struct Inflated {
    mesh::VolumeMesh mesh = hollow_bar({3, 3, 3}, {3, 3, 3}, {{1, 1, 1}});
    Eigen::VectorXd u = scatter(mesh.nodes.size(), 0.05), none = Eigen::VectorXd::Zero(u.size());
    static BodySetting setting(MaterialLaw law) {
        return {law, {.young = 0.7, .poisson = 0.4, .density = 0}, {.pressure = 0.2}};
    }
};

TEST(Pressure, ForceAndTangentAreDerivatives) {
    // Of what pressure does: with and without. Directions are drawn, as there are many nodes.
    const Inflated box;
    const HyperelasticBody body = body_of(box.mesh);
    for (const MaterialLaw law : laws) {
        const BodySetting on = Inflated::setting(law);
        BodySetting off = on;
        off.effects.pressure = 0;
        const auto energy = [&](const Eigen::VectorXd& u) {
            return body.potential(u, on, box.none) - body.potential(u, off, box.none);
        };
        const auto push = [&](const Eigen::VectorXd& u) -> Eigen::VectorXd {
            return body.residual(u, on, box.none) - body.residual(u, off, box.none);
        };
        const Eigen::SparseMatrix<double> J = body.tangent(box.u, on) - body.tangent(box.u, off);
        const Eigen::SparseMatrix<double> mirrored = J.transpose();
        EXPECT_LT((J - mirrored).norm(), 1e-14 * J.norm() + 1e-300);
        for (unsigned seed = 0; seed < 5; ++seed) {
            const Eigen::VectorXd along = scatter(box.u.size(), 1, seed);
            constexpr double h = 1e-5;
            const Eigen::VectorXd ahead = box.u + h * along, behind = box.u - h * along;
            // Truncation h^2 and rounding 1e-16 / h.
            EXPECT_NEAR((energy(ahead) - energy(behind)) / (2 * h), -push(box.u).dot(along), 1e-8);
            EXPECT_LT(((push(behind) - push(ahead)) / (2 * h) - J * along).norm(), 1e-8);
        }
        if (law != MaterialLaw::linear) {
            EXPECT_NEAR(energy(box.u), -0.2 * (body.cavity_volume(box.u) - 1), 1e-13);  // rounding
        }
        // A closed cavity pushes the body nowhere.
        const Eigen::VectorXd f = push(box.u);
        EXPECT_LT(f.reshaped(3, f.size() / 3).rowwise().sum().norm(), 1e-14);
        EXPECT_GT(f.norm(), 0.1);
    }
}

TEST(Pressure, WithoutCavityIsOfNoAccount) {
    const Beam beam({2, 1, 1}, {2, 1, 1});
    const Eigen::VectorXd u = scatter(beam.mesh.nodes.size(), 0.05), none = Eigen::VectorXd::Zero(u.size());
    const BodySetting on = Inflated::setting(MaterialLaw::neo_hookean);
    BodySetting off = on;
    off.effects.pressure = 0;
    EXPECT_EQ(beam.body().residual(u, on, none), beam.body().residual(u, off, none));
}

/// A hollow sphere of radii 1 and 2, and how far its inner and outer surface move out under a pressure.
std::array<double, 2> swelling(MaterialLaw law, const Material& material, double pressure) {
    const auto mesh = spherical_shell(1, 2, 4, 2);
    // Springs a hundred-thousandth as stiff, all over the outside, keep it from floating away.
    const HyperelasticBody body(mesh, nodes_where(mesh, [](const Vec3& x) { return x.norm() > 2 - 1e-9; }));
    const BodySetting setting{
        law, material, {.points = {std::make_shared<Springs>(ActsOn::support, 1e-5, 0.0)}, .pressure = pressure}};
    const Eigen::VectorXd u = body.equilibrium(setting, Eigen::VectorXd::Zero(mesh.nodes.size())).u;
    std::array<double, 2> sum{};
    std::array<int, 2> count{};
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
        const Vec3 X = mesh.nodes.row(i);
        for (int side = 0; side < 2; ++side) {
            if (std::abs(X.norm() - (side + 1)) > 1e-9) continue;
            sum[side] += u.segment<3>(3 * i).dot(X.normalized());
            ++count[side];
        }
    }
    return {sum[0] / count[0], sum[1] / count[1]};
}

TEST(Pressure, HollowSphereSwellsAsLameSays) {
    // u(r) = p a^3 / (b^3 - a^3) ((1 - 2 nu) r + (1 + nu) b^3 / (2 r^2)) / E
    const Material material{.young = 0.5, .poisson = 0.4, .density = 0};
    const double p = 0.01, a = 1, b = 2;
    const auto theory = [&](double r) {
        return p / (b * b * b - 1) * (0.2 * r + 1.4 * b * b * b / (2 * r * r)) / material.young;
    };
    const auto [inner, outer] = swelling(MaterialLaw::linear, material, p);
    EXPECT_NEAR(inner / theory(a), 1, 0.005);  // four layers of elements
    EXPECT_NEAR(outer / theory(b), 1, 0.005);
}

TEST(Pressure, BalloonBearsWhatItsEnergySays) {
    // A sphere that keeps its volume: p = int from s(b) to s(a) of W'(s) / (s^3 - 1) ds, s the hoop stretch and
    // W = mu/2 (2 s^2 + s^-4 - 3).
    const Material material{.young = 0.3, .poisson = 0.499, .density = 0};
    const double mu = material.shear_modulus(), stretch = 1.2;
    const double outer_stretch = std::cbrt(1 + (std::pow(stretch, 3) - 1) / 8);
    double p = 0;
    constexpr int parts = 1000;
    for (int k = 0; k < parts; ++k) {
        const double s = outer_stretch + (stretch - outer_stretch) * (k + 0.5) / parts;
        p += (stretch - outer_stretch) / parts * 2 * mu * (s - std::pow(s, -5)) / (s * s * s - 1);
    }
    const auto [inner, outer] = swelling(MaterialLaw::neo_hookean, material, p);
    EXPECT_NEAR(inner, stretch - 1, 0.0035 * (stretch - 1));  // four layers of elements
    EXPECT_NEAR(outer, 2 * (outer_stretch - 1), 0.0035 * 2 * (outer_stretch - 1));
}

}  // namespace
}  // namespace palpate::fem
