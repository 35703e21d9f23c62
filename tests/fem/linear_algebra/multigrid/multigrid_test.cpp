#include "fem/linear_algebra/multigrid/multigrid.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "fem/elements/assembly.h"
#include "fem/linear_algebra/conjugate_gradients.h"
#include "fem/linear_algebra/multigrid/chebyshev.h"
#include "fem/linear_algebra/multigrid/morton.h"
#include "tests/fem/bodies.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::HasSubstr;

template <int R, int C, class Value>
Eigen::MatrixXd dense(const BlockMatrix<R, C, Value>& A) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(R * A.rows(), C * A.columns);
    for (int i = 0; i < A.rows(); ++i) {
        for (int k = 0; k < A.count(i); ++k) {
            result.block(R * i, C * A.columns_of(i)[k], R, C) = A.block(i, k).template cast<double>();
        }
    }
    return result;
}

MultiVector scattered(Eigen::Index rows, Eigen::Index columns) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    return MultiVector::NullaryExpr(rows, columns, [&] { return uniform(engine); });
}

/// A jittered bar, and its matrix over the nodes that are not held.
struct Bar {
    mesh::VolumeMesh mesh;
    std::vector<int> number;
    Points free;
    BlockMatrix<3, 3> A;

    Bar(const Vec3& size, const Eigen::Vector3i& cells, bool is_held = true, double poisson = 0.3)
        : mesh(jittered_bar(Kind::quadratic, size, cells)) {
        int count = 0;
        for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
            number.push_back(is_held && mesh.nodes(i, 0) < 1e-9 ? -1 : count++);
        }
        free.resize(count, 3);
        for (std::size_t i = 0; i < number.size(); ++i) {
            if (number[i] >= 0) free.row(number[i]) = mesh.nodes.row(static_cast<Eigen::Index>(i));
        }
        A = assemble_blocks(mesh, {.body = {.young = 0.2, .poisson = poisson}}, Dilatation::mean, number);
    }
};

TEST(BlockMatrix, IsTheStiffnessMatrix) {
    const Bar bar({3, 1, 1}, {4, 2, 2});
    const auto K =
        assemble<int>(bar.mesh, {.body = {.young = 0.2, .poisson = 0.3}}, Dilatation::mean, bar.number, Half::both);
    EXPECT_EQ(dense(bar.A), Eigen::MatrixXd(K));
}

TEST(BlockMatrix, OfALowerHalfIsWhole) {
    const Bar bar({3, 1, 1}, {4, 2, 2});
    const auto K = assemble<std::int64_t>(bar.mesh, {.body = {.young = 0.2, .poisson = 0.3}}, Dilatation::mean,
                                          bar.number, Half::lower);
    const BlockMatrix<3, 3> whole = symmetric_blocks(K);
    EXPECT_EQ(whole.column, bar.A.column);
    EXPECT_LT((dense(whole) - dense(bar.A)).norm(), 1e-15 * dense(bar.A).norm());
}

TEST(BlockMatrix, ProductsAreThoseOfDenseMatrices) {
    const Bar bar({3, 1, 1}, {4, 2, 2});
    const auto P = tentative_prolongator<3>(aggregate(bar.A, 0.03), rigid_modes(bar.free)).P;
    const auto AP = product(bar.A, P);
    const auto PAP = product(transpose(P), AP);
    const Eigen::MatrixXd A = dense(bar.A), p = dense(P);
    // Rounding of sums of some hundred terms, here and below.
    EXPECT_LT((dense(AP) - A * p).norm(), 1e-14 * A.norm());
    EXPECT_LT((dense(PAP) - p.transpose() * A * p).norm(), 1e-14 * A.norm());
    for (const int columns : {1, 3, 8, 11}) {
        const MultiVector X = scattered(A.cols(), columns), Z = scattered(P.columns * 6, columns);
        MultiVector Y = X, W = X;
        multiply(bar.A, X, Y, Join::subtract);
        EXPECT_LT((Y - (X - A * X)).norm(), 1e-14 * A.norm() * X.norm()) << columns;
        multiply(P, Z, W);
        EXPECT_LT((W - p * Z).norm(), 1e-14 * Z.norm()) << columns;
    }
}

TEST(BlockMatrix, InSinglePrecisionIsRoundedAndItsProductsAreExact) {
    const Bar bar({3, 1, 1}, {4, 2, 2});
    const auto P = tentative_prolongator<3>(aggregate(bar.A, 0.03), rigid_modes(bar.free)).P;
    const auto coarse = product(transpose(P), product(bar.A, P));
    const auto check = [](const auto& exact) {
        const auto A = rounded(exact);
        const Eigen::MatrixXd a = dense(A);
        const Eigen::MatrixXf single = dense(exact).template cast<float>();
        EXPECT_EQ(a, single.cast<double>());
        for (const int columns : {1, 3, 8, 11}) {
            const MultiVector X = scattered(a.cols(), columns), before = scattered(a.rows(), columns);
            MultiVector Y = before;
            multiply(A, X, Y, Join::add);
            EXPECT_LT((Y - (before + a * X)).norm(), 1e-14 * (a.norm() * X.norm() + before.norm())) << columns;
        }
    };
    check(bar.A);
    check(P);
    check(transpose(P));
    check(coarse);
}

TEST(Aggregates, HoldEachNodeOnceAndMany) {
    const Bar bar({6, 2, 2}, {9, 3, 3});
    const Aggregates aggregates = aggregate(bar.A, 0.03);
    std::vector<int> members(aggregates.count, 0);
    for (const int a : aggregates.of_node) {
        ASSERT_TRUE(a >= 0 && a < aggregates.count);
        ++members[a];
    }
    // Six rigid modes differ on three nodes and more.
    EXPECT_GE(*std::ranges::min_element(members), 3);
    EXPECT_LT(aggregates.count, bar.A.rows() / 8);
}

TEST(Aggregates, DoNotJoinWhatIsWeaklyConnected) {
    // Layers of nodes far apart along x: springs of stiffness 1 along it, of 100 across.
    constexpr int n = 6;
    std::vector<std::vector<int>> pattern(n * n);
    const auto node = [](int layer, int place) { return n * layer + place; };
    for (int l = 0; l < n; ++l) {
        for (int k = 0; k < n; ++k) {
            for (int other = 0; other < n * n; ++other) {
                const bool along = other % n == k && std::abs(other / n - l) <= 1;
                const bool across = other / n == l && std::abs(other % n - k) <= 1;
                if (along || across) pattern[node(l, k)].push_back(other);
            }
        }
    }
    auto A = with_pattern<3, 3>(pattern, n * n);
    for (int i = 0; i < A.rows(); ++i) {
        for (int k = 0; k < A.count(i); ++k) {
            const int j = A.columns_of(i)[k];
            A.block(i, k) = (j == i ? 202.0 : j / n == i / n ? -100.0 : -1.0) * Mat3::Identity();
        }
    }
    const Aggregates aggregates = aggregate(A, 0.1);
    for (int i = 0; i < n * n; ++i) {
        for (int j = 0; j < n * n; ++j) {
            if (aggregates.of_node[i] == aggregates.of_node[j]) {
                EXPECT_EQ(i / n, j / n);
            }
        }
    }
}

/// Largest difference of P modes_coarse and modes, as a share of the modes' own size.
template <int b>
double missed(const BlockMatrix<b, 6>& P, const RigidModes& coarse, const RigidModes& modes) {
    MultiVector X = coarse, Y(modes.rows(), 6);
    multiply(P, X, Y);
    return (Y - modes).cwiseAbs().maxCoeff() / modes.cwiseAbs().maxCoeff();
}

TEST(Prolongator, HoldsTheRigidModesOnEachLevel) {
    // Of a free body, which they cost no energy: A modes = 0, so that smoothing keeps them, too.
    const Bar bar({6, 2, 2}, {18, 6, 6}, false);
    RigidModes modes = rigid_modes(bar.free);
    auto [P, coarse] = tentative_prolongator<3>(aggregate(bar.A, 0.03), modes);
    EXPECT_LT(missed(P, coarse, modes), 1e-12);
    smooth(P, bar.A, inverse_diagonal(bar.A), 2.0);
    EXPECT_LT(missed(P, coarse, modes), 1e-12);

    const auto A = product(transpose(P), product(bar.A, P));
    auto [next, coarsest] = tentative_prolongator<6>(aggregate(A, 0.015), coarse);
    EXPECT_LT(next.columns, P.columns / 4);
    EXPECT_LT(missed(next, coarsest, coarse), 1e-12);
    smooth(next, A, inverse_diagonal(A), 2.0);
    EXPECT_LT(missed(next, coarsest, coarse), 1e-12);
}

TEST(Prolongator, HoldsTheRigidModesOfAggregatesThatAreTooSmallForSix) {
    // A node alone has three of them, two nodes have five.
    const Bar bar({2, 1, 1}, {2, 1, 1}, false);
    Aggregates aggregates{std::vector<int>(bar.A.rows(), 0), 3};
    aggregates.of_node[0] = 1;
    aggregates.of_node[1] = aggregates.of_node[2] = 2;
    const RigidModes modes = rigid_modes(bar.free);
    const auto [P, coarse] = tentative_prolongator<3>(aggregates, modes);
    EXPECT_LT(missed(P, coarse, modes), 1e-12);
    EXPECT_EQ(coarse.middleRows(6, 6).rowwise().any().count(), 3);
    EXPECT_EQ(coarse.middleRows(12, 6).rowwise().any().count(), 5);
}

TEST(MortonOrder, KeepsNeighboursTogetherWhateverOrderTheyCameIn) {
    // The corners of 8 x 8 x 8 cells: each block of 2 x 2 x 2 comes in a row.
    Points corners(512, 3);
    for (int i = 0; i < 512; ++i) corners.row(i) << i / 64, i / 8 % 8, i % 8;
    std::vector<int> shuffled(512);
    std::iota(shuffled.begin(), shuffled.end(), 0);
    std::ranges::shuffle(shuffled, std::mt19937(3));
    const Points given = corners(shuffled, Eigen::all);
    const std::vector<int> order = morton_order(given);
    for (int first = 0; first < 512; first += 8) {
        const Points block = given(std::vector<int>(order.begin() + first, order.begin() + first + 8), Eigen::all);
        EXPECT_EQ((block.colwise().maxCoeff() - block.colwise().minCoeff()).maxCoeff(), 1) << first;
    }
}

TEST(Chebyshev, FindsTheLargestEigenvalue) {
    const Bar bar({3, 1, 1}, {4, 2, 2});
    const auto D = inverse_diagonal(bar.A);
    const double found = largest_eigenvalue(bar.A, D);
    const double largest = (dense(D) * dense(bar.A)).eigenvalues().cwiseAbs().maxCoeff();
    // From below, and no further than the smoother allows for.
    EXPECT_LE(found, largest * (1 + 1e-10));
    EXPECT_GT(found * 1.05, largest);
}

TEST(Multigrid, IsSymmetricAndPositive) {
    const Bar bar({12, 2, 2}, {36, 6, 6});
    const Multigrid M(bar.A, rigid_modes(bar.free), {.coarsest_nodes = 20});
    EXPECT_GE(M.levels(), 3);
    const MultiVector X = scattered(M.matrix().rows() * 3, 4);
    MultiVector spent = X, Y;
    M.apply(spent, Y);
    const Eigen::MatrixXd products = X.transpose() * Y;
    EXPECT_LT((products - products.transpose()).norm(), 1e-12 * products.norm());
    EXPECT_GT(Eigen::MatrixXd(products).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
}

TEST(ConjugateGradients, TakeHardlyMoreStepsOnFinerMeshes) {
    // With each halving of the edges the condition grows fourfold; without multigrid steps would double.
    std::vector<int> steps;
    for (const int cells : {3, 6, 12}) {
        const Bar bar({3, 1, 1}, {3 * cells, cells, cells});
        const Multigrid M(bar.A, rigid_modes(bar.free), {.coarsest_nodes = 40});
        MultiVector X = scattered(M.matrix().rows() * 3, 1);
        steps.push_back(conjugate_gradients(M, X));
    }
    EXPECT_LT(steps[2], 45);
    EXPECT_LE(steps[1], 1.35 * steps[0]);
    EXPECT_LE(steps[2], 1.35 * steps[1]);
}

TEST(ConjugateGradients, StopAloud) {
    const Bar bar({6, 2, 2}, {12, 4, 4});
    const Multigrid M(bar.A, rigid_modes(bar.free));
    MultiVector X = scattered(M.matrix().rows() * 3, 2);
    EXPECT_TRUE(says(message_of<SolverFailure>([&] { conjugate_gradients(M, X, {.iterations = 3}); }),
                     {"stopped after 3 iterations", "1e-11 asked for", "one edge or corner", "more memory"}));
}

TEST(ConjugateGradients, TruncatedTheyEndWithWhatTheyHave) {
    const Bar bar({6, 2, 2}, {12, 4, 4});
    const Multigrid M(bar.A, rigid_modes(bar.free));
    const MultiVector F = scattered(M.matrix().rows() * 3, 2);
    MultiVector whole = F, some = F;
    conjugate_gradients(M, whole);
    EXPECT_EQ(conjugate_gradients(M, some, {.iterations = 3, .truncated = true}), 3);
    for (int j = 0; j < 2; ++j) {
        EXPECT_GT(some.col(j).dot(F.col(j)), 0);
        EXPECT_LT((some - whole).col(j).norm(), whole.col(j).norm());
    }
}

TEST(ConjugateGradients, ColumnsAreSolvedForEachOnItsOwn) {
    const Bar bar({6, 2, 2}, {12, 4, 4});
    const Multigrid M(bar.A, rigid_modes(bar.free));
    const MultiVector F = scattered(M.matrix().rows() * 3, 8) * Eigen::VectorXd::LinSpaced(8, 0, 7).asDiagonal();
    MultiVector X = F;
    conjugate_gradients(M, X);
    EXPECT_EQ(X.col(0).norm(), 0);  // no load, no displacement
    for (const int j : {1, 7}) {
        MultiVector alone = F.col(j);
        conjugate_gradients(M, alone);
        EXPECT_LT((alone - X.col(j)).norm(), 1e-9 * alone.norm());  // a hundred times the tolerance
    }
}

}  // namespace
}  // namespace palpate::fem
