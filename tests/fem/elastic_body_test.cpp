#include "fem/elastic_body.h"
#include "fem/hyperelastic_body.h"

#include <algorithm>

#include "bodies.h"
#include "fem/elements/patch_load.h"
#include "mesh/errors.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A jittered bar held at x = 0 with 9 contacts on top; fine enough that its factor has supernodes of several tiles.
struct Probed {
    mesh::VolumeMesh mesh = jittered_bar(Kind::curved, {6, 3, 3}, {10, 5, 5});
    std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.2; });
    Material material{.young = 0.2, .poisson = 0.47};
    Eigen::SparseMatrix<double> loads;

    Probed() {
        std::vector<mesh::Contact> contacts;
        for (int k = 0; k < 9; ++k) contacts.push_back({{1.5 + 0.5 * k, 1, 3}, Vec3(0.1 * k, 0.3, -1), 0.6});
        loads = patch_loads(mesh, contacts, 0.2);
    }
};

TEST(ElasticBody, ForcesBalance) {
    const Probed p;
    const ElasticBody body(p.mesh, p.material, p.held);
    const Eigen::MatrixXd U = body.solve(p.loads);
    Eigen::MatrixXd left = stiffness(p.mesh, p.material, body.stats().dilatation) * U - Eigen::MatrixXd(p.loads);
    for (std::size_t i = 0; i < p.held.size(); ++i) {
        if (!p.held[i]) continue;
        left.middleRows<3>(3 * i).setZero();
        EXPECT_EQ(U.middleRows<3>(3 * i).norm(), 0);
    }
    // Rounding times the condition of a slender bar at nu = 0.47.
    EXPECT_LT(left.norm(), 1e-10 * p.loads.norm());
}

TEST(ElasticBody, OfSeveralMaterialsBalancesEachOnesForces) {
    // Against the body in large deformation at the linear law, which sums its forces element by element; both with the
    // full dilatation, as below nu = 0.45, and exactly integrated, as elements are straight.
    Probed p;
    p.mesh = mesh::to_quadratic(mesh::make_bar({0, 0, 0}, {6, 3, 3}, {6, 3, 3}));
    p.held = nodes_where(p.mesh, [](const Vec3& x) { return x.x() < 1e-9; });
    p.loads = patch_loads(p.mesh, {{{4, 1, 3}, Vec3(0.2, 0.3, -1), 0.8}}, 0.2);
    Materials materials{.body = {.young = 0.2, .poisson = 0.3},
                        .regions = {{.young = 5, .poisson = 0.3}, {.young = 0.01, .poisson = 0.4}}};
    for (Eigen::Index e = 0; e < p.mesh.tetrahedra.rows(); ++e)
        materials.of_element.push_back(static_cast<int>(e % 3) - 1);
    const ElasticBody body(p.mesh, materials, p.held);
    const Eigen::VectorXd f = Eigen::MatrixXd(p.loads).col(0);
    const Eigen::VectorXd u = body.solve(Eigen::MatrixXd(f));
    const HyperelasticBody same(p.mesh, p.held, body.stats().dilatation, {materials.of_element, {1, 1}});
    BodySetting setting;
    setting.law = MaterialLaw::linear;
    setting.material = materials.body;
    setting.regions = materials.regions;
    Eigen::VectorXd left = same.residual(u, setting, f);
    for (std::size_t i = 0; i < p.held.size(); ++i)
        if (p.held[i]) left.segment<3>(static_cast<Eigen::Index>(3 * i)).setZero();
    EXPECT_LT(left.norm(), 1e-9 * f.norm());  // rounding, as above
    // And they matter.
    const Eigen::VectorXd of_one = ElasticBody(p.mesh, materials.body, p.held).solve(Eigen::MatrixXd(f));
    EXPECT_GT((u - of_one).norm(), 0.1 * of_one.norm());
}

TEST(ElasticBody, SolutionsAreReciprocal) {
    // Betti: the work of load i on the displacement of load j is the work of j on that of i.
    const Probed p;
    const Eigen::MatrixXd U = ElasticBody(p.mesh, p.material, p.held).solve(p.loads);
    const Eigen::MatrixXd work = p.loads.transpose() * U;
    EXPECT_LT((work - work.transpose()).norm(), 1e-11 * work.norm());
    EXPECT_GT(work.diagonal().minCoeff(), 0);
}

TEST(ElasticBody, ThreadsDoNotChangeANumber) {
    const Probed p;
    const Eigen::MatrixXd one = ElasticBody(p.mesh, p.material, p.held, {.threads = 1, .block = 2}).solve(p.loads);
    for (const int threads : {2, 5}) {
        const ElasticBody body(p.mesh, p.material, p.held, {.threads = threads, .block = 2});
        EXPECT_EQ(body.solve(p.loads), one) << threads;
    }
}

TEST(ElasticBody, DenseAndSparseLoadsAndBlocksAgree) {
    const Probed p;
    const Eigen::MatrixXd U = ElasticBody(p.mesh, p.material, p.held, {.block = 64}).solve(p.loads);
    const ElasticBody single(p.mesh, p.material, p.held, {.block = 1});
    // Products of other shapes sum in another order: rounding times condition.
    EXPECT_LT((single.solve(p.loads) - U).norm(), 1e-11 * U.norm());
    EXPECT_LT((single.solve(Eigen::MatrixXd(p.loads)) - U).norm(), 1e-11 * U.norm());
}

/// Unit forces at nodes of a thick body, whose last supernodes have several panels and strips of tiles.
struct Thick {
    mesh::VolumeMesh mesh = jittered_bar(Kind::quadratic, {4, 4, 4}, {9, 9, 9});
    std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; });
    Eigen::SparseMatrix<double> loads{mesh.nodes.size(), 150};

    Thick() {
        for (int j = 0; j < loads.cols(); ++j) loads.insert(3 * (mesh.nodes.rows() - 1 - 11 * j) + j % 3, j) = 1;
    }
};

TEST(ElasticBody, ThreadsDoNotChangeANumberOfThickBodies) {
    const Thick p;
    const Eigen::MatrixXd one = ElasticBody(p.mesh, {.young = 0.2}, p.held).solve(p.loads);
    for (const int threads : {2, 5}) {
        EXPECT_EQ(ElasticBody(p.mesh, {.young = 0.2}, p.held, {.threads = threads}).solve(p.loads), one) << threads;
    }
}

TEST(ElasticBody, ManyLoadsMoveAsEachAlone) {
    const Thick p;
    const ElasticBody body(p.mesh, {.young = 0.2}, p.held, {.threads = 2});
    const Eigen::MatrixXd U = body.solve(p.loads);
    for (int j = 0; j < p.loads.cols(); j += 7) {
        const Eigen::MatrixXd u = body.solve(Eigen::SparseMatrix<double>(p.loads.col(j)));
        EXPECT_LT((U.col(j) - u).norm(), 1e-11 * u.norm()) << j;
    }
}

TEST(ElasticBody, NoLoadsNoColumns) {
    const Probed p;
    const ElasticBody body(p.mesh, p.material, p.held);
    EXPECT_EQ(body.solve(Eigen::SparseMatrix<double>(p.mesh.nodes.size(), 0)).cols(), 0);
}

TEST(ElasticBody, TakesMeanDilatationFromThePoissonRatioOn) {
    const Probed p;
    EXPECT_EQ(ElasticBody(p.mesh, {.poisson = 0.45}, p.held).stats().dilatation, Dilatation::mean);
    EXPECT_EQ(ElasticBody(p.mesh, {.poisson = 0.44}, p.held).stats().dilatation, Dilatation::full);
}

/// The complaint about a linear bar of 4 x 1 x 1 mm held where `condition` says.
std::string complaint(const std::function<bool(const Vec3&)>& condition, const ElasticBodyOptions& options = {}) {
    const auto bar = mesh::make_bar({0, 0, 0}, {4, 1, 1}, {4, 1, 1});
    return message_of<InvalidInput>([&] { ElasticBody(bar, {.poisson = 0.3}, nodes_where(bar, condition), options); });
}

TEST(ElasticBodyInput, TooLittleHeldIsNamed) {
    EXPECT_THAT(complaint([](const Vec3&) { return false; }),
                AllOf(HasSubstr("Nothing is held"), HasSubstr("(0, 0, 0) to (4, 1, 1) mm")));
    EXPECT_THAT(complaint([](const Vec3&) { return true; }), HasSubstr("All 20 nodes of the body lie in a support"));
    EXPECT_THAT(complaint([](const Vec3& x) { return x.norm() < 0.1; }),
                HasSubstr("can move as a rigid body: 1 of its nodes"));
    // Five nodes on one line leave the rotation about it.
    EXPECT_THAT(complaint([](const Vec3& x) { return x.y() < 0.1 && x.z() < 0.1; }),
                HasSubstr("can move as a rigid body: 5 of its nodes"));
}

TEST(ElasticBodyInput, OptionsOutOfRangeAreNamed) {
    const auto clamp = [](const Vec3& x) { return x.x() < 0.1; };
    EXPECT_THAT(complaint(clamp, {.threads = 0}), HasSubstr("threads is 0"));
    EXPECT_THAT(complaint(clamp, {.block = 0}), HasSubstr("block (right-hand sides solved together) is 0"));
    EXPECT_THAT(complaint(clamp, {.block = 1025}), HasSubstr("allowed: 1 to 1024"));
}

/// Two bars in one mesh, the second moved by `shift`; nodes at equal places become one.
mesh::VolumeMesh two_bars(const Vec3& shift) {
    mesh::VolumeMesh mesh = mesh::make_bar({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
    const mesh::VolumeMesh first = mesh;
    std::vector<int> index;
    for (Eigen::Index i = 0; i < first.nodes.rows(); ++i) {
        const Vec3 x = first.nodes.row(i).transpose() + shift;
        Eigen::Index same = 0;
        while (same < first.nodes.rows() && (first.nodes.row(same).transpose() - x).norm() > 1e-9) ++same;
        if (same == first.nodes.rows()) {
            same = mesh.nodes.rows();
            mesh.nodes.conservativeResize(same + 1, 3);
            mesh.nodes.row(same) = x;
        }
        index.push_back(static_cast<int>(same));
    }
    const auto renumbered = [&](int i) { return index[i]; };
    mesh.tetrahedra.resize(2 * first.tetrahedra.rows(), 4);
    mesh.tetrahedra << first.tetrahedra, first.tetrahedra.unaryExpr(renumbered);
    mesh.faces = mesh::boundary_faces(mesh.tetrahedra);
    return mesh;
}

std::vector<char> left_end(const mesh::VolumeMesh& mesh) {
    return nodes_where(mesh, [](const Vec3& x) { return x.x() < 0.1; });
}

TEST(ElasticBodyInput, LoosePartsAreNamed) {
    const auto apart = two_bars({5, 0, 0});
    EXPECT_THAT(message_of<InvalidInput>([&] { ElasticBody(apart, {.poisson = 0.3}, left_end(apart)); }),
                AllOf(HasSubstr("around (6, 0.5, 0.5) mm (12 nodes)"), HasSubstr("0 of its nodes are held")));
}

TEST(ElasticBodyInput, PartsOnAHingeAreFound) {
    const auto hinged = two_bars({2, 0, 1});
    EXPECT_THAT(message_of<SolverFailure>([&] { ElasticBody(hinged, {.poisson = 0.3}, left_end(hinged)); }),
                HasSubstr("hang on the rest by one edge or corner only"));
    // Joined by a face it is a sound body.
    const auto joined = two_bars({2, 0, 0});
    EXPECT_NO_THROW(ElasticBody(joined, {.poisson = 0.3}, left_end(joined)));
}

TEST(ElasticBodyInput, NodesWithoutElementAreNamed) {
    auto bar = mesh::make_bar({0, 0, 0}, {4, 1, 1}, {4, 1, 1});
    bar.nodes.conservativeResize(21, 3);
    bar.nodes.row(20) = Vec3(2, 2, 2);
    EXPECT_THAT(message_of<InvalidInput>([&] { ElasticBody(bar, {.poisson = 0.3}, left_end(bar)); }),
                HasSubstr("Node 20 of the volume mesh, at (2, 2, 2) mm, belongs to no element"));
}

}  // namespace
}  // namespace palpate::fem
