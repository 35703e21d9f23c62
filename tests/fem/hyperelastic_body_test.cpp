#include "beam.h"
#include "mesh/errors.h"
#include "point_potentials.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A small bar, held at x = 0.
struct Bar {
    mesh::VolumeMesh mesh;
    std::vector<char> held;

    explicit Bar(Kind kind, const Eigen::Vector3i& cells = {2, 1, 1})
        : mesh(jittered_bar(kind, cells.cast<double>(), cells)),
          held(nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; })) {}
    HyperelasticBody body(Dilatation dilatation = Dilatation::mean) const { return {mesh, held, dilatation}; }
    Eigen::Index dofs() const { return mesh.nodes.size(); }
};

BodySetting loaded(MaterialLaw law) {
    return {law,
            {.young = 0.7, .poisson = 0.4, .density = 1e-3},
            {.points = {std::make_shared<Weight>(Vec3(3, -2, 1)), std::make_shared<Springs>(ActsOn::support, 0.4, 5.0),
                        std::make_shared<Springs>(ActsOn::surface, 0.1, 20.0)}}};
}

BodySetting bare(MaterialLaw law) { return {law, {.young = 0.7, .poisson = 0.4, .density = 1e-3}, {}}; }

TEST(HyperelasticBody, ForceIsMinusGradientOfPotential) {
    const Bar bar(Kind::curved);
    const Eigen::VectorXd u = scatter(bar.dofs(), 0.03), f = scatter(bar.dofs(), 0.01, 5);
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body = bar.body(dilatation);
        for (const MaterialLaw law : laws) {
            const BodySetting setting = loaded(law);
            const Eigen::VectorXd r = body.residual(u, setting, f);
            const auto energy = [&](const Eigen::VectorXd& at) {
                return Eigen::VectorXd::Constant(1, body.potential(at, setting, f)).eval();
            };
            const Eigen::VectorXd slope = -differences(energy, u, 1e-5).transpose();
            // Truncation h^2 and rounding 1e-16 / h, both times the energy's size.
            EXPECT_LT((slope - r).norm(), 1e-8 * r.norm()) << static_cast<int>(law);
        }
    }
}

TEST(HyperelasticBody, TangentIsDerivativeOfForce) {
    const Bar bar(Kind::curved);
    const Eigen::VectorXd u = scatter(bar.dofs(), 0.03), none = Eigen::VectorXd::Zero(u.size());
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body = bar.body(dilatation);
        for (const MaterialLaw law : laws) {
            const BodySetting setting = loaded(law);
            const Eigen::MatrixXd J = body.tangent(u, setting);
            EXPECT_EQ(J, J.transpose());
            const auto force = [&](const Eigen::VectorXd& at) { return body.residual(at, setting, none); };
            const Eigen::MatrixXd change = -differences(force, u, 1e-5);
            // As above; forces bend more than energies.
            EXPECT_LT((change - J).norm(), 1e-7 * J.norm()) << static_cast<int>(law);
        }
    }
}

TEST(HyperelasticBody, FactorSolvesWithTheTangentOfTheFreeNodes) {
    const Bar bar(Kind::curved, {3, 1, 1});
    const HyperelasticBody body = bar.body();
    const Eigen::VectorXd u = scatter(bar.dofs(), 0.002);
    Eigen::MatrixXd B(u.size(), 70);  // more than are solved together
    for (Eigen::Index j = 0; j < B.cols(); ++j) B.col(j) = scatter(u.size(), 1, static_cast<unsigned>(j));

    const BodySetting held = bare(MaterialLaw::neo_hookean);
    const Eigen::MatrixXd X = body.factor(u, held)->solve(B);
    Eigen::MatrixXd left = body.tangent(u, held) * X - B;
    for (std::size_t i = 0; i < bar.held.size(); ++i) {
        if (!bar.held[i]) continue;
        EXPECT_EQ(X.middleRows<3>(3 * i).norm(), 0);
        left.middleRows<3>(3 * i).setZero();
    }
    // Rounding times condition.
    EXPECT_LT(left.norm(), 1e-11 * B.norm());

    // An effect on the support releases it: then no row is left out.
    const BodySetting released = loaded(MaterialLaw::neo_hookean);
    EXPECT_LT((body.tangent(u, released) * body.factor(u, released)->solve(B) - B).norm(), 1e-11 * B.norm());
}

TEST(HyperelasticBody, NoLoadsAreSolvedInSilence) {
    const Bar bar(Kind::curved, {3, 1, 1});
    const HyperelasticBody body = bar.body();
    const auto factor = body.factor(Eigen::VectorXd::Zero(bar.dofs()), bare(MaterialLaw::neo_hookean));
    testing::internal::CaptureStdout();  // where BLAS complains
    const Eigen::MatrixXd X = factor->solve(Eigen::MatrixXd(bar.dofs(), 0));
    std::fflush(stdout);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(X.cols(), 0);
}

TEST(HyperelasticBody, HomogeneousDeformationPullsAtNoInnerNode) {
    // The patch test. Curved elements pass it in the limit only: four points do not sum their gradients exactly.
    const Mat3 G = (Mat3() << 0.2, 0.1, -0.05, 0.03, -0.15, 0.08, -0.1, 0.04, 0.12).finished();
    const Bar bar(Kind::quadratic, {3, 3, 3});
    const std::vector<char> outside = boundary_nodes(bar.mesh);
    const Eigen::VectorXd u = nodal(bar.mesh, [&](const Vec3& x) { return Vec3(G * x); });
    for (const Dilatation dilatation : dilatations) {
        for (const MaterialLaw law : laws) {
            const Eigen::VectorXd r = bar.body(dilatation).residual(u, bare(law), Eigen::VectorXd::Zero(u.size()));
            double inner = 0;
            for (std::size_t i = 0; i < outside.size(); ++i) {
                if (!outside[i]) inner = std::max(inner, r.segment<3>(3 * i).norm());
            }
            EXPECT_LT(inner, 1e-14) << static_cast<int>(law);  // rounding; the skin's forces are about 0.03 N
            EXPECT_GT(r.norm(), 0.1);
        }
    }
}

TEST(HyperelasticBody, HomogeneousDeformationCostsItsDensityTimesVolume) {
    const Mat3 G = (Mat3() << 0.2, 0.1, -0.05, 0.03, -0.15, 0.08, -0.1, 0.04, 0.12).finished();
    const Mat3 F = Mat3::Identity() + G, E = (F.transpose() * F - Mat3::Identity()) / 2, eps = (G + G.transpose()) / 2;
    const auto distortion = [](const Mat3& strain) {
        return (strain - strain.trace() / 3 * Mat3::Identity()).squaredNorm();
    };
    const double mu = 0.7 / 2.8, K = 0.7 / 0.6, J = F.determinant();
    const std::array density{mu * distortion(eps) + K / 2 * eps.trace() * eps.trace(),
                             mu * distortion(E) + K / 2 * E.trace() * E.trace(),
                             mu / 2 * (std::pow(J, -2.0 / 3) * F.squaredNorm() - 3) + K / 2 * (J - 1) * (J - 1)};
    const Bar bar(Kind::quadratic, {2, 2, 2});
    const Eigen::VectorXd u = nodal(bar.mesh, [&](const Vec3& x) { return Vec3(G * x); });
    for (const Dilatation dilatation : dilatations) {
        for (std::size_t k = 0; k < laws.size(); ++k) {
            const double energy = bar.body(dilatation).potential(u, bare(laws[k]), Eigen::VectorXd::Zero(u.size()));
            EXPECT_NEAR(energy / 8, density[k], 1e-14);  // rounding; 8 mm^3
        }
    }
}

TEST(HyperelasticBody, RigidMotionCostsNothing) {
    const Bar bar(Kind::curved);
    const Mat3 R = Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    const Eigen::VectorXd u = nodal(bar.mesh, [&](const Vec3& x) { return Vec3(R * x - x + Vec3(3, 0, 1)); });
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        EXPECT_NEAR(bar.body().potential(u, bare(law), none), 0, 1e-14);
        EXPECT_LT(bar.body().residual(u, bare(law), none).norm(), 1e-13);  // rounding
    }
}

TEST(HyperelasticBody, ForcesSplitByModulusAndElement) {
    const Bar bar(Kind::curved);
    const Eigen::VectorXd u = scatter(bar.dofs(), 0.03), none = Eigen::VectorXd::Zero(u.size());
    const Eigen::Index elements = bar.mesh.tetrahedra.rows();
    Eigen::MatrixXd W = Eigen::MatrixXd::Ones(elements, 3);
    W.col(1).setLinSpaced(0, 2);
    W.col(2).array() -= W.col(1).array();
    for (const Dilatation dilatation : dilatations) {
        const HyperelasticBody body = bar.body(dilatation);
        for (const MaterialLaw law : laws) {
            const BodySetting setting = bare(law);
            const Eigen::VectorXd internal = -body.residual(u, setting, none);
            const double tolerance = 1e-13 * internal.norm();  // rounding
            const double mu = 0.7 / (2 * 1.4), K = 0.7 / (3 * 0.2);
            EXPECT_LT((body.modulus_forces(u, setting) * Eigen::Vector2d(mu, K) - internal).norm(), tolerance);
            const Eigen::MatrixXd forces = body.element_forces(u, setting, W);
            EXPECT_LT((forces.col(0) - internal).norm(), tolerance);
            EXPECT_LT((forces.col(1) + forces.col(2) - internal).norm(), tolerance);
            EXPECT_GT((forces.col(1) - internal).norm(), 0.1 * internal.norm());
        }
    }
}

TEST(HyperelasticBody, PointsWeighWhatTheyStandFor) {
    const Bar bar(Kind::quadratic, {3, 2, 2});
    const HyperelasticBody body = bar.body();
    const NodeWeights mass = body.points(ActsOn::material, 2.0), skin = body.points(ActsOn::surface, 2.0);
    const NodeWeights support = body.points(ActsOn::support, 2.0);
    EXPECT_NEAR(mass.weights.sum(), 2.0 * 12, 1e-12);  // 3 x 2 x 2 mm; rounding
    EXPECT_NEAR(skin.weights.sum(), 32, 1e-12);
    EXPECT_NEAR(support.weights.sum(), 1, 1e-14);
    EXPECT_GT(support.weights.minCoeff(), 0);
    EXPECT_EQ(support.nodes.size(), std::ranges::count(bar.held, 1));
    for (const int node : support.nodes) EXPECT_TRUE(bar.held[node]);
    // The centre of mass: moments of linear fields are exact too.
    Vec3 moment = Vec3::Zero();
    for (std::size_t k = 0; k < mass.nodes.size(); ++k) {
        moment += mass.weights(static_cast<Eigen::Index>(k)) * bar.mesh.nodes.row(mass.nodes[k]).transpose();
    }
    EXPECT_LT((moment - 24 * Vec3(1.5, 1, 1)).norm(), 1e-12);
    EXPECT_TRUE(body.points(ActsOn::material, 0).nodes.empty());
}

TEST(HyperelasticBody, InsideOutElementsHaveNoForce) {
    const Bar bar(Kind::quadratic);
    const HyperelasticBody body = bar.body();
    const Eigen::VectorXd mirrored = nodal(bar.mesh, [](const Vec3& x) { return Vec3(-2 * x.x(), 0, 0); });
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(mirrored.size());
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        EXPECT_EQ(body.potential(mirrored, bare(law), none), INFINITY);
        const auto says_where = AllOf(HasSubstr("Element 0 of the body"), HasSubstr("turned inside out"));
        EXPECT_THAT(message_of<SolverFailure>([&] { body.residual(mirrored, bare(law), none); }), says_where);
        EXPECT_THAT(message_of<SolverFailure>([&] { body.tangent(mirrored, bare(law)); }), says_where);
        EXPECT_THAT(message_of<SolverFailure>([&] { body.modulus_forces(mirrored, bare(law)); }), says_where);
    }
    EXPECT_TRUE(std::isfinite(body.potential(mirrored, bare(MaterialLaw::linear), none)));
}

TEST(HyperelasticBodyInput, UnstableStatesHaveNoFactor) {
    // Pressed to half its length, the bar would rather buckle.
    const Bar bar(Kind::quadratic, {6, 1, 1});
    const Eigen::VectorXd u = nodal(bar.mesh, [](const Vec3& x) { return Vec3(-0.5 * x.x(), 0, 0); });
    EXPECT_THAT(message_of<SolverFailure>([&] { bar.body().factor(u, bare(MaterialLaw::neo_hookean)); }),
                HasSubstr("tangent is not positive definite"));
}

TEST(HyperelasticBodyInput, UnfitMeshesAreNamed) {
    const Bar linear(Kind::linear), quadratic(Kind::quadratic);
    EXPECT_THAT(message_of<InvalidInput>([&] { linear.body(); }),
                AllOf(HasSubstr("have 4 nodes"), HasSubstr("quadratic tetrahedra of 10")));
    Bar turned = quadratic;
    turned.mesh.nodes.col(0) *= -1;
    EXPECT_THAT(message_of<InvalidInput>([&] { turned.body(); }),
                AllOf(HasSubstr("Element 0 of the volume mesh"), HasSubstr("turned inside out")));
    Bar loose = quadratic;
    loose.held.assign(loose.held.size(), 0);
    EXPECT_THAT(message_of<InvalidInput>([&] { loose.body(); }), HasSubstr("Nothing is held"));
}

TEST(HyperelasticBodyInput, ValuesOutOfRangeAreNamed) {
    const Bar bar(Kind::quadratic);
    const HyperelasticBody body = bar.body();
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(bar.dofs());
    const auto complaint = [&](const BodySetting& setting, const NewtonOptions& options) {
        return message_of<InvalidInput>([&] { body.equilibrium(setting, none, options); });
    };
    BodySetting hollow = bare(MaterialLaw::svk);
    hollow.material.poisson = 0.5;
    EXPECT_THAT(complaint(hollow, {}), HasSubstr("Poisson's ratio is 0.5"));
    EXPECT_THAT(complaint(bare(MaterialLaw::svk), {.tolerance = 0}), HasSubstr("tolerance (share of the load"));
    EXPECT_THAT(complaint(bare(MaterialLaw::svk), {.iterations = 0}),
                HasSubstr("iterations is 0; allowed: 1 and more"));
}

}  // namespace
}  // namespace palpate::fem
