#include <array>
#include <limits>

#include "bodies.h"
#include "fem/elastic_body.h"
#include "fem/elements/patch_load.h"
#include "fem/linear_algebra/solver_choice.h"
#include "fem/solver_forecast.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

constexpr double no_memory = 1e-9;  // [GB]: no factor fits

/// A bar held at x = 0, with loads on its top and one on all of its nodes.
struct LoadedBar {
    mesh::VolumeMesh mesh;
    std::vector<char> held;
    Eigen::MatrixXd loads;

    LoadedBar(Kind kind, const Vec3& size, const Eigen::Vector3i& cells)
        : mesh(jittered_bar(kind, size, cells)), held(nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; })) {
        std::vector<mesh::Contact> contacts;
        for (int k = 1; k <= 10; ++k) {
            contacts.push_back({{0.095 * k * size.x(), size.y() / 2, size.z()}, Vec3(0.1 * k, 0.3, -1), size.y() / 4});
        }
        loads.resize(mesh.nodes.size(), 11);
        loads << Eigen::MatrixXd(patch_loads(mesh, contacts, 0.1)), gravity_load(mesh, 1e-9, Vec3(1, 0, -9810));
    }
    ElasticBody body(double poisson, const ElasticBodyOptions& options) const {
        return {mesh, {.young = 0.2, .poisson = poisson}, held, options};
    }
    /// Largest difference of the displacements by conjugate gradients from those by a factor, as a share of these.
    double difference(double poisson) const {
        const ElasticBody without = body(poisson, {.memory = no_memory});
        EXPECT_GE(without.stats().levels, 2);
        const Eigen::MatrixXd U = body(poisson, {.memory = 100}).solve(loads), V = without.solve(loads);
        EXPECT_GT(without.most_iterations(), 0);
        return ((V - U).colwise().norm().array() / U.colwise().norm().array()).maxCoeff();
    }
};

// Conjugate gradients stop at 1e-11 in the energy norm, of which the displacements' own is some hundred times at most.

TEST(LargeBody, SlenderOnesMoveAsByAFactor) {
    EXPECT_LT(LoadedBar(Kind::quadratic, {60, 2, 2}, {60, 2, 2}).difference(0.3), 1e-8);
}

TEST(LargeBody, ThickOnesMoveAsByAFactor) {
    EXPECT_LT(LoadedBar(Kind::curved, {4, 4, 4}, {9, 9, 9}).difference(0.3), 1e-8);
}

TEST(LargeBody, NearlyIncompressibleOnesMoveAsByAFactor) {
    const LoadedBar bar(Kind::quadratic, {12, 4, 4}, {18, 6, 6});
    for (const double poisson : {0.45, 0.49}) EXPECT_LT(bar.difference(poisson), 1e-8) << poisson;
}

TEST(LargeBody, ThoseOfLinearElementsMoveAsByAFactor) {
    EXPECT_LT(LoadedBar(Kind::linear, {12, 4, 4}, {30, 10, 10}).difference(0.3), 1e-8);
}

TEST(LargeBody, ElementsThatAreFlatMoveAsByAFactor) {
    EXPECT_LT(LoadedBar(Kind::quadratic, {10, 10, 0.5}, {10, 10, 2}).difference(0.3), 1e-8);
}

TEST(LargeBody, ThreadsDoNotChangeANumber) {
    const LoadedBar bar(Kind::quadratic, {12, 4, 4}, {18, 6, 6});
    const Eigen::MatrixXd one = bar.body(0.3, {.threads = 1, .memory = no_memory}).solve(bar.loads);
    EXPECT_EQ(bar.body(0.3, {.threads = 4, .memory = no_memory}).solve(bar.loads), one);
}

TEST(LargeBody, SparseAndDenseLoadsAgree) {
    const LoadedBar bar(Kind::quadratic, {12, 4, 4}, {12, 4, 4});
    const ElasticBody body = bar.body(0.3, {.memory = no_memory});
    const Eigen::MatrixXd U = body.solve(bar.loads);
    EXPECT_LT((body.solve(Eigen::SparseMatrix<double>(bar.loads.sparseView())) - U).norm(), 1e-9 * U.norm());
}

TEST(LargeBody, SaysWhyThereIsNoFactor) {
    const LoadedBar bar(Kind::quadratic, {12, 4, 4}, {6, 2, 2});
    const ElasticBody direct = bar.body(0.3, {});
    EXPECT_EQ(direct.stats().note, "");
    EXPECT_EQ(direct.stats().levels, 0);
    const ElasticBody body = bar.body(0.3, {.memory = 1e-4});
    EXPECT_TRUE(says(body.stats().note, {"would take", "of 0.0001 GB", "conjugate gradients with multigrid instead"}));
    EXPECT_EQ(body.stats().factor_entries, direct.stats().factor_entries);
}

TEST(LargeBody, AFewLoadsOfAThickOneTakeNoFactor) {
    const LoadedBar bar(Kind::linear, {10, 10, 10}, {38, 38, 38});
    const ElasticBody body = bar.body(0.3, {.loads = 1});
    EXPECT_GE(body.stats().levels, 2);
    EXPECT_TRUE(says(body.stats().note, {"would take longer than 1 load(s) without it", "multigrid instead"}));
}

/// A dense matrix, or a diagonal one.
Supernodes supernodes_of(int unknowns, bool is_dense) {
    const int count = is_dense ? 1 : unknowns, columns = unknowns / count;
    Supernodes result{{0}, {0}, {0}, {}, std::vector<int>(count, -1)};
    for (int s = 0; s < count; ++s) {
        result.first_column.push_back(columns * (s + 1));
        for (int r = 0; r < columns; ++r) result.rows.push_back(columns * s + r);
        result.first_row.push_back(std::ssize(result.rows));
        result.first_value.push_back(result.first_value.back() + std::int64_t{columns} * columns);
    }
    return result;
}

TEST(LargeBody, AFactorIsLeftOutWhereItsProductsOutweighTheLoads) {
    const FactorCost dense = cost_of_factor(supernodes_of(12000, true), {});  // 12000^3 / 6 products: some seconds
    EXPECT_TRUE(is_faster_without_factor(dense, 1));
    EXPECT_FALSE(is_faster_without_factor(dense, 1000));
    EXPECT_FALSE(is_faster_without_factor(dense, 0));  // nobody said how many
    EXPECT_FALSE(is_faster_without_factor(cost_of_factor(supernodes_of(12000, false), {}), 1));
}

TEST(LargeBody, AFactorOfMoreNodesIsForetoldByNestedDissection) {
    const LoadedBar coarse(Kind::quadratic, {6, 6, 6}, {8, 8, 8}), fine(Kind::quadratic, {6, 6, 6}, {14, 14, 14});
    const auto nodes = static_cast<double>(fine.mesh.nodes.rows());
    const SolverForecast told = forecast_solver(coarse.mesh, coarse.held, nodes, 0, Solver::factor);
    const double factor = 8e-9 * fine.body(0.3, {}).stats().factor_entries;
    // The law is of large cubes, and the faces are a part of these; what is told has the matrix besides.
    EXPECT_GT(told.gigabytes, 0.8 * factor);
    EXPECT_LT(told.gigabytes, 1.4 * factor);
    EXPECT_THAT(told.words, testing::HasSubstr("as was asked for"));
}

TEST(LargeBody, AForecastOfABodyItselfChoosesAsTheBodyDoes) {
    const LoadedBar bar(Kind::quadratic, {6, 6, 6}, {12, 12, 12});
    for (const int loads : {1, 500}) {
        const ElasticBody body = bar.body(0.3, {.loads = loads});
        const auto nodes = static_cast<double>(bar.mesh.nodes.rows());
        const SolverForecast told = forecast_solver(bar.mesh, bar.held, nodes, loads, Solver::automatic);
        EXPECT_EQ(told.solver, body.stats().solver) << loads;
        EXPECT_TRUE(told.fits());
        EXPECT_GT(told.seconds_to_make, 0);
    }
    // Of eight times the nodes a factor takes 64 times as long: one load is not worth it.
    const auto more = 8 * static_cast<double>(bar.mesh.nodes.rows());
    EXPECT_EQ(forecast_solver(bar.mesh, bar.held, more, 1, Solver::automatic).solver, Solver::multigrid);
}

TEST(LargeBody, PartsOnAHingeAreFound) {
    // Two bars that share one edge: the second can turn about it.
    mesh::VolumeMesh mesh = mesh::make_bar({0, 0, 0}, {4, 4, 4}, {4, 4, 4});
    const mesh::VolumeMesh second = mesh::make_bar({4, 0, 4}, {8, 4, 8}, {4, 4, 4});
    std::vector<int> index;
    for (Eigen::Index i = 0; i < second.nodes.rows(); ++i) {
        Eigen::Index same = 0;
        while (same < mesh.nodes.rows() && (mesh.nodes.row(same) - second.nodes.row(i)).norm() > 1e-9) ++same;
        index.push_back(static_cast<int>(same));
        if (same < mesh.nodes.rows()) continue;
        mesh.nodes.conservativeResize(same + 1, 3);
        mesh.nodes.row(same) = second.nodes.row(i);
    }
    const Tetrahedra first = mesh.tetrahedra;
    mesh.tetrahedra.resize(first.rows() + second.tetrahedra.rows(), 4);
    mesh.tetrahedra << first, second.tetrahedra.unaryExpr([&](int i) { return index[i]; });
    mesh.faces = mesh::boundary_faces(mesh.tetrahedra);
    const auto held = nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; });
    const Eigen::VectorXd load = gravity_load(mesh, 1e-9, Vec3(0, 0, -9810));
    const std::string complaint = message_of<SolverFailure>(
        [&] { ElasticBody(mesh, {.poisson = 0.3}, held, {.memory = no_memory}).solve(Eigen::MatrixXd(load)); });
    EXPECT_TRUE(says(complaint, {"one edge or corner only"}));
}

TEST(LargeBody, LoadsOutOfRangeAreNamed) {
    const LoadedBar bar(Kind::quadratic, {12, 4, 4}, {6, 2, 2});
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { bar.body(0.3, {.loads = -1}); }),
                     {"loads (to be solved for) is -1", "allowed: 0 and more"}));
}

TEST(LargeBody, MemoryOutOfRangeIsNamed) {
    const LoadedBar bar(Kind::quadratic, {12, 4, 4}, {6, 2, 2});
    for (const double memory : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
        const std::string complaint = message_of<InvalidInput>([&] { bar.body(0.3, {.memory = memory}); });
        EXPECT_TRUE(says(complaint, {"memory (that a factor may take)", "allowed: 0 and more"}));
    }
}

}  // namespace
}  // namespace palpate::fem
