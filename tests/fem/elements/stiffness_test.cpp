#include "fem/elements/stiffness.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <tuple>

#include "mesh/errors.h"
#include "tests/fem/bodies.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::HasSubstr;

/// Everything that assembles: elements, and how they keep their volume.
class Stiffness : public testing::TestWithParam<std::tuple<Kind, Dilatation>> {
protected:
    Kind kind() const { return std::get<0>(GetParam()); }
    SparseMatrix stiffness_of(const mesh::VolumeMesh& mesh) const {
        return stiffness(mesh, material, std::get<1>(GetParam()));
    }
    const Material material{.young = 2.0, .poisson = 0.35};
};

INSTANTIATE_TEST_SUITE_P(AllElements, Stiffness,
                         testing::Values(std::tuple(Kind::linear, Dilatation::full),
                                         std::tuple(Kind::quadratic, Dilatation::full),
                                         std::tuple(Kind::quadratic, Dilatation::mean),
                                         std::tuple(Kind::curved, Dilatation::full),
                                         std::tuple(Kind::curved, Dilatation::mean)));

double volume_of(const mesh::VolumeMesh& mesh) { return gravity_load(mesh, 1.0, Vec3::UnitX()).sum(); }

TEST_P(Stiffness, PassesThePatchTest) {
    const auto mesh = jittered_bar(kind(), {3, 3, 3}, {3, 3, 3});
    Mat3 A;
    A << 0.1, 0.3, -0.2, 0.05, -0.4, 0.15, 0.25, 0.1, 0.2;
    const Eigen::VectorXd u = nodal(mesh, [&](const Vec3& x) { return Vec3(A * x + Vec3(1, 2, 3)); });
    const Eigen::VectorXd force = stiffness_of(mesh) * u;

    // A linear field is in equilibrium inside, to rounding.
    const auto outside = boundary_nodes(mesh);
    double inner = 0;
    for (std::size_t i = 0; i < outside.size(); ++i) {
        if (!outside[i]) inner = std::max(inner, force.segment<3>(3 * i).norm());
    }
    EXPECT_LT(inner, 1e-13 * force.cwiseAbs().sum());

    // Its energy is the density of Hooke's law times the volume, to rounding.
    const Mat3 strain = (A + A.transpose()) / 2;
    const double density =
        material.shear_modulus() * strain.squaredNorm() + material.lame_lambda() / 2 * strain.trace() * strain.trace();
    EXPECT_NEAR(u.dot(force) / 2, density * volume_of(mesh), 1e-12 * density * volume_of(mesh));
}

TEST_P(Stiffness, IsSymmetric) {
    const SparseMatrix K = stiffness_of(jittered_bar(kind(), {2, 2, 1}, {2, 2, 1}));
    const SparseMatrix transposed = K.transpose();
    // Sums in another order differ by rounding.
    EXPECT_LT((K - transposed).norm(), 1e-14 * K.norm());
}

TEST_P(Stiffness, OnlyRigidMotionsAreFree) {
    const auto mesh = jittered_bar(kind(), {2, 1, 1}, {2, 1, 1});
    const SparseMatrix K = stiffness_of(mesh);
    for (int a = 0; a < 3; ++a) {
        const auto shift = nodal(mesh, [&](const Vec3&) { return Vec3::Unit(a); });
        const auto turn = nodal(mesh, [&](const Vec3& x) { return Vec3::Unit(a).cross(x); });
        EXPECT_LT((K * shift).norm(), 1e-14 * K.norm());
        EXPECT_LT((K * turn).norm(), 1e-14 * K.norm() * turn.norm());
    }
    // Six eigenvalues of rounding's size, then a gap: no other motion is free.
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(K)).eigenvalues();
    EXPECT_LT(values.head<6>().cwiseAbs().maxCoeff(), 1e-13 * values.maxCoeff());
    EXPECT_GT(values(6), 1e-4 * values.maxCoeff());
}

TEST_P(Stiffness, WeightIsDensityTimesVolumeAtTheCentroid) {
    // Unjittered, so that the body is a box of known volume; bows are kept.
    mesh::VolumeMesh mesh = jittered_bar(kind() == Kind::linear ? Kind::linear : Kind::quadratic, {4, 2, 1}, {4, 2, 2});
    const double density = 1e-9;
    const Vec3 g(0, 3000, -9810), weight = density * 8 * g;
    const Eigen::VectorXd load = gravity_load(mesh, density, g);
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
        const Vec3 f = load.segment<3>(3 * i), x = mesh.nodes.row(i);
        force += f;
        moment += x.cross(f);
    }
    // Rounding: the rule is exact for straight elements.
    EXPECT_LT((force - weight).norm(), 1e-13 * weight.norm());
    EXPECT_LT((moment - Vec3(2, 1, 0.5).cross(weight)).norm(), 1e-13 * weight.norm() * 4);
}

TEST(StiffnessInput, LinearElementsThatLockAreRefused) {
    const auto mesh = mesh::make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    EXPECT_THAT(message_of<InvalidInput>([&] { stiffness(mesh, {.poisson = 0.45}, Dilatation::full); }),
                HasSubstr("Poisson's ratio is 0.45 on linear tetrahedra"));
    EXPECT_NO_THROW(stiffness(mesh, {.poisson = 0.4}, Dilatation::full));
}

TEST(StiffnessInput, MaterialsOutOfRangeAreRefused) {
    const auto mesh = mesh::to_quadratic(mesh::make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
    EXPECT_THAT(message_of<InvalidInput>([&] { stiffness(mesh, {.poisson = 0.5}, Dilatation::mean); }),
                HasSubstr("Poisson's ratio is 0.5"));
}

TEST(StiffnessInput, ElementsInsideOutAreNamed) {
    auto mesh = mesh::make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    mesh.tetrahedra.row(3).head<2>().reverseInPlace();
    EXPECT_THAT(message_of<InvalidInput>([&] { stiffness(mesh, {.poisson = 0.3}, Dilatation::full); }),
                HasSubstr("Element 3 of the volume mesh"));
}

}  // namespace
}  // namespace palpate::fem
