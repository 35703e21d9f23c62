#include "mesh/meshing/tetrahedralise.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "mesh/errors.h"
#include "mesh/system/child_process.h"
#include "tests/mesh/faulty_surfaces.h"
#include "tests/messages.h"
#include "tests/sanitizers.h"

namespace palpate::mesh {
namespace {

/// All elements positive, the volume that of the surface, whose vertices come first.
void expect_filled(const Surface& surface, double volume, const TetrahedraliseOptions& options = {}) {
    const VolumeMesh body = tetrahedralise(surface, options);
    const Eigen::VectorXd volumes = element_volumes(body);
    EXPECT_GT(volumes.minCoeff(), 0);
    EXPECT_NEAR(volumes.sum(), volume, 1e-9 * volume);  // the surface is kept: round-off only
    EXPECT_EQ(body.nodes.topRows(surface.vertices.rows()), surface.vertices);
    EXPECT_EQ(body.faces.rows(), surface.triangles.rows());
    EXPECT_NEAR(signed_volume(boundary_surface(body)), volume, 1e-9 * volume);
}

TEST(Tetrahedralise, FillsABoxABallAndAHollowBall) {
    expect_filled(cube(), 1000);
    expect_filled(make_sphere({100, 0, 0}, 10, 2), signed_volume(make_sphere({100, 0, 0}, 10, 2)));
    expect_filled(hollow_ball(), signed_volume(hollow_ball()));
    // A ball in the hollow of the ball.
    const Surface nested = join(hollow_ball(), make_sphere({0, 0, 0}, 2, 1));
    expect_filled(nested, signed_volume(nested));
}

TEST(Tetrahedralise, AnyUnitOfLengthWillDo) {
    for (const double scale : {1e-3, 1e3}) {
        Surface small = make_sphere({0, 0, 0}, 10, 2);
        small.vertices *= scale;
        expect_filled(small, signed_volume(small));
    }
}

TEST(Tetrahedralise, ShorterEdgesMakeMoreElements) {
    const auto elements = [](double edge) { return tetrahedralise(cube(), {.edge_length = edge}).tetrahedra.rows(); };
    EXPECT_GT(elements(1), 4 * elements(2));  // eight times but for the skin
}

TEST(Tetrahedralise, ABrokenSurfaceIsAnErrorNotACrash) {
    const Surface crossing = join(cube(), make_sphere({10, 5, 5}, 3, 2));
    EXPECT_TRUE(says(message_of<SolverFailure>([&] { tetrahedralise(crossing); }), {"TetGen", "Repair"}));
    EXPECT_TRUE(says(message_of<SolverFailure>([] { tetrahedralise(with_spike(cube())); }), {"TetGen", "Repair"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { tetrahedralise(without_triangle(cube(), 7)); }),
                     {"not closed", "3 open edges", "Repair"}));
    Surface loose = cube();
    loose.vertices.conservativeResize(99, 3);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { tetrahedralise(loose); }), {"vertex 98", "no triangle"}));
}

TEST(Tetrahedralise, TheTimeLimitHolds) {
    const TetrahedraliseOptions options{.edge_length = 0.05, .time_limit = 0.1};
    EXPECT_TRUE(
        says(message_of<SolverFailure>([&] { tetrahedralise(cube(), options); }), {"time limit", "0.1 s", "larger"}));
}

TEST(Tetrahedralise, TheMemoryLimitHolds) {
#ifdef PALPATE_ADDRESS_SANITIZER
    GTEST_SKIP() << "the address sanitizer has its own way to run out of memory";
#endif
    const TetrahedraliseOptions options{.edge_length = 0.05, .memory_limit = 16};
    EXPECT_TRUE(says(message_of<SolverFailure>([&] { tetrahedralise(cube(), options); }),
                     {"memory limit", "16 MiB", "larger"}));
}

TEST(Tetrahedralise, LeavesNoChildBehind) {
    EXPECT_THROW(tetrahedralise(cube(), {.edge_length = 0.05, .time_limit = 0.05}), SolverFailure);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
}

TEST(Tetrahedralise, WorksFromSeveralThreadsAlike) {
    const VolumeMesh alone = tetrahedralise(cube());
    std::vector<VolumeMesh> found(3);
    std::vector<std::thread> threads;
    for (auto& body : found) threads.emplace_back([&body] { body = tetrahedralise(cube()); });
    for (auto& thread : threads) thread.join();
    for (const VolumeMesh& body : found) {
        EXPECT_EQ(body.nodes, alone.nodes);
        EXPECT_EQ(body.tetrahedra, alone.tetrahedra);
    }
}

TEST(Tetrahedralise, OptionsNameTheirBounds) {
    const auto refusal = [](const TetrahedraliseOptions& options) {
        return message_of<InvalidInput>([&] { options.validate(); });
    };
    EXPECT_TRUE(says(refusal({.edge_length = -1}), {"edge_length", "-1"}));
    EXPECT_TRUE(says(refusal({.quality = 1}), {"quality", "1.1", "3"}));
    EXPECT_TRUE(says(refusal({.time_limit = 0}), {"time_limit"}));
    EXPECT_TRUE(says(refusal({.memory_limit = 1}), {"memory_limit", "16"}));
}

TEST(ChildProcess, TellsHowItEnded) {
    using End = ChildResult::End;
    const ChildLimits limits{5, 512};
    const ChildResult answer = run_in_child([] { return std::string(3'000'000, 'x'); }, limits);
    EXPECT_EQ(answer.end, End::Answered);
    EXPECT_EQ(answer.answer, std::string(3'000'000, 'x'));

    const ChildResult crash = run_in_child(
        []() -> std::string {
            std::raise(SIGSEGV);
            return {};
        },
        limits);
    EXPECT_EQ(crash.end, End::Crashed);
    EXPECT_EQ(crash.signal, SIGSEGV);

    EXPECT_EQ(run_in_child([]() -> std::string { throw 3; }, limits).end, End::Failed);
    EXPECT_EQ(run_in_child([]() -> std::string { throw std::bad_alloc(); }, limits).end, End::OutOfMemory);
    EXPECT_EQ(run_in_child([]() -> std::string { std::_Exit(0); }, limits).end, End::Failed);

    const auto hang = []() -> std::string {
        for (std::atomic<int> i = 0;; ++i) {
        }
    };
    EXPECT_EQ(run_in_child(hang, {0.2, 512}).end, End::OutOfTime);
}

}  // namespace
}  // namespace palpate::mesh
