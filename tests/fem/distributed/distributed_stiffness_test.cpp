// Run by mpirun with several processes: the first runs the tests, the others hold their share of the bodies.

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <thread>
#include <vector>

#include "fem/distributed/distributed_stiffness.h"
#include "fem/distributed/petsc/body_part.h"
#include "fem/distributed/processes.h"
#include "fem/elastic_body.h"
#include "fem/elements/assembly.h"
#include "fem/elements/patch_load.h"
#include "tests/fem/bodies.h"
#include "tests/fem/large_deformation/solve/iterated.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

/// A bar of two materials, held at x = 0, with loads on its top and its weight.
struct Bar {
    mesh::VolumeMesh mesh;
    std::vector<char> held;
    Materials materials;
    Eigen::MatrixXd loads;

    Bar(Kind kind, double poisson, const Eigen::Vector3i& cells = {18, 6, 6})
        : mesh(jittered_bar(kind, {12, 4, 4}, cells)),
          held(nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; })),
          materials{{.young = 0.2, .poisson = poisson}, {{.young = 2, .poisson = 0.3}}, {}} {
        for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e)
            materials.of_element.push_back(mesh.nodes(mesh.tetrahedra(e, 0), 0) > 6 ? 0 : -1);
        std::vector<mesh::Contact> contacts;
        for (int k = 1; k <= 3; ++k) contacts.push_back({{4.0 * k - 0.5, 2, 4}, Vec3(0.1 * k, 0.3, -1), 1});
        loads.resize(mesh.nodes.size(), 5);
        loads << Eigen::MatrixXd(patch_loads(mesh, contacts, 0.1)), gravity_load(mesh, 1e-9, Vec3(1, 0, -9810)),
            Eigen::VectorXd::Zero(mesh.nodes.size());
    }
    ElasticBody body(Solver solver) const { return {mesh, materials, held, {.solver = solver}}; }
    double difference_from_factor() const {
        const ElasticBody shared = body(Solver::petsc);
        EXPECT_EQ(shared.stats().solver, Solver::petsc);
        const Eigen::MatrixXd U = body(Solver::factor).solve(loads), V = shared.solve(loads);
        EXPECT_GT(shared.most_iterations(), 2);
        EXPECT_TRUE(V.col(4).isZero(0));
        return ((V - U).leftCols(4).colwise().norm().array() / U.leftCols(4).colwise().norm().array()).maxCoeff();
    }
};

// Conjugate gradients stop at 1e-11 in the energy norm, of which the displacements' own is some hundred times at most.

TEST(DistributedStiffness, MovesABodyAsAFactorDoes) {
    EXPECT_LT(Bar(Kind::quadratic, 0.3).difference_from_factor(), 1e-8);
    EXPECT_LT(Bar(Kind::curved, 0.3).difference_from_factor(), 1e-8);
    EXPECT_LT(Bar(Kind::linear, 0.3).difference_from_factor(), 1e-8);
}

TEST(DistributedStiffness, MovesANearlyIncompressibleBodyAsAFactorDoes) {
    EXPECT_LT(Bar(Kind::quadratic, 0.49).difference_from_factor(), 1e-8);
}

TEST(DistributedStiffness, HoldsSeveralBodiesAtOnce) {
    const Bar one(Kind::quadratic, 0.3, {9, 3, 3}), other(Kind::linear, 0.3, {9, 3, 3});
    const Eigen::MatrixXd U = one.body(Solver::factor).solve(one.loads);
    const ElasticBody first = one.body(Solver::petsc);
    {
        const ElasticBody second = other.body(Solver::petsc);
        second.solve(other.loads);
    }
    EXPECT_LT((first.solve(one.loads) - U).norm(), 1e-8 * U.norm());
}

TEST(DistributedStiffness, ServesThreadsOneAtATime) {
    const Bar bar(Kind::quadratic, 0.3, {6, 2, 2});
    const Eigen::MatrixXd U = bar.body(Solver::factor).solve(bar.loads);
    std::vector<double> differences(4, 1);
    std::vector<std::thread> threads;
    for (double& difference : differences) {
        threads.emplace_back([&] {
            for (int k = 0; k < 5; ++k) difference = (bar.body(Solver::petsc).solve(bar.loads) - U).norm() / U.norm();
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const double difference : differences) EXPECT_LT(difference, 1e-8);
}

TEST(DistributedStiffness, SaysWhatSolves) {
    const Bar bar(Kind::quadratic, 0.3, {6, 2, 2});
    EXPECT_THAT(bar.body(Solver::petsc).stats().note,
                testing::AllOf(testing::HasSubstr("PETSc, cg and gamg"),
                               testing::HasSubstr(fmt::format("{} process", Processes::count()))));
}

TEST(DistributedStiffness, AnElementThatIsInsideOutIsNamedAndTheProcessesGoOn) {
    Bar bar(Kind::quadratic, 0.3, {6, 2, 2});
    const Eigen::RowVector3d kept = bar.mesh.nodes.row(bar.mesh.tetrahedra(40, 0));
    bar.mesh.nodes.row(bar.mesh.tetrahedra(40, 0)) += Eigen::RowVector3d(5, 0, 0);
    EXPECT_ANY_THROW(bar.body(Solver::petsc));
    bar.mesh.nodes.row(bar.mesh.tetrahedra(40, 0)) = kept;
    EXPECT_LT(bar.difference_from_factor(), 1e-8);
}

// Several processes on a core wait for each other most of the time: few and small bodies.

TEST(DistributedStiffness, FindsAnEquilibriumInLargeDeformationAsAFactorDoes) {
    const Beam beam({8, 2, 2}, {6, 2, 2});
    expect_as_by_a_factor(Solver::petsc,
                          {{"bent", beam, {MaterialLaw::neo_hookean, {}, {}}, beam.end_force({0, 0, -0.003})}});
}

TEST(DistributedStiffness, AColumnThatBucklesIsFollowed) {
    if (Processes::count() > 2) GTEST_SKIP() << "takes minutes on few cores";
    expect_as_by_a_factor(Solver::petsc, {iterated_cases().back()});
}

TEST(PartitionNodes, SharesAllFreeNodesAboutEvenly) {
    const Bar bar(Kind::quadratic, 0.3);
    const int parts = 5;
    const Partition partition = partition_nodes(bar.mesh, bar.held, parts);
    std::set<int> seen;
    for (std::size_t i = 0; i < bar.held.size(); ++i) {
        EXPECT_EQ(partition.number[i] < 0, bar.held[i] != 0);
        if (partition.number[i] >= 0) seen.insert(partition.number[i]);
    }
    const int free = static_cast<int>(std::ranges::count(bar.held, 0));
    EXPECT_EQ(std::ssize(seen), free);
    EXPECT_EQ(partition.first.front(), 0);
    EXPECT_EQ(partition.first.back(), free);
    for (int part = 0; part < parts; ++part) {
        const double own = partition.first[part + 1] - partition.first[part];
        EXPECT_NEAR(own, free / 5.0,
                    0.1 * free / 5.0);  // METIS keeps imbalance within 3 %, of small parts within some nodes
    }
}

/// The rows of all parts, piece by piece, are those of the whole matrix.
TEST(BodyParts, AssembleTheRowsOfTheWhole) {
    const Bar bar(Kind::quadratic, 0.49, {9, 3, 3});
    const Partition partition = partition_nodes(bar.mesh, bar.held, 3);
    const BlockMatrix<3, 3> whole = assemble_blocks(bar.mesh, bar.materials, Dilatation::mean, partition.number);
    int rows = 0;
    for (int k = 0; k < 3; ++k) {
        const BodyPart part = part_of(bar.mesh, bar.materials, Dilatation::mean, partition, k);
        EXPECT_LT(part.mesh.tetrahedra.rows(), bar.mesh.tetrahedra.rows());
        for_pieces(part, 50, [&](int begin, const BodyPart& piece) {
            EXPECT_EQ(piece.first, part.first + begin);
            std::vector<int> number(piece.number.size(), -1), global;
            for (std::size_t i = 0; i < number.size(); ++i) {
                if (piece.number[i] < 0) continue;
                number[i] = static_cast<int>(global.size());
                global.push_back(piece.number[i]);
            }
            const auto own = assemble_blocks(piece.mesh, piece.materials, piece.dilatation, number);
            for (int i = 0; i < piece.own; ++i, ++rows) {
                const int row = piece.first + i;
                ASSERT_EQ(own.count(i), whole.count(row));
                for (int c = 0; c < own.count(i); ++c) {
                    const int column = global[own.columns_of(i)[c]];
                    const auto at = std::ranges::find(whole.columns_of(row), column) - whole.columns_of(row).begin();
                    ASSERT_LT(at, whole.count(row));
                    const Eigen::Matrix3d block = whole.block(row, static_cast<int>(at));
                    EXPECT_LT((own.block(i, c) - block).norm(), 1e-13 * whole.panel(row).norm());
                }
            }
        });
    }
    EXPECT_EQ(rows, whole.rows());
}

}  // namespace
}  // namespace palpate::fem

int main(int argc, char** argv) {
    palpate::fem::Processes processes;
    if (!processes.lead()) {
        processes.serve();
        return 0;
    }
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
