// How good a skeleton is: measures on shapes with known answers, and `palpate skeleton --quality` on a small box.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/quality/errors.h"
#include "pipeline/analysis/quality/graph.h"
#include "pipeline/analysis/quality/probed_body.h"
#include "pipeline/analysis/quality/shape.h"
#include "pipeline/command_line/commands.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

skeleton::Model model_of(const mesh::Surface& surface, const std::vector<Vec3>& centers, double radius,
                         const std::vector<std::pair<int, int>>& links = {}) {
    skeleton::Model model;
    model.surface = surface;
    for (const Vec3& center : centers) model.spheres.push_back({.center = center, .radius = radius});
    for (const auto& [a, b] : links) {
        skeleton::Link link;
        link.a = a;
        link.b = b;
        link.length = (centers[b] - centers[a]).norm();
        model.links.push_back(link);
    }
    return model;
}

/// Round the z axis: R to the middle of the tube, r its radius.
mesh::Surface make_torus(double R, double r) {
    constexpr int around = 48, across = 24;
    mesh::Surface torus;
    torus.vertices.resize(around * across, 3);
    torus.triangles.resize(2 * around * across, 3);
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
            const double out = R + r * std::cos(v);
            const int n = i * across + j;
            torus.vertices.row(n) << out * std::cos(u), out * std::sin(u), r * std::sin(v);
            const int next_i = (i + 1) % around * across + j, next_j = i * across + (j + 1) % across,
                      next = (i + 1) % around * across + (j + 1) % across;
            torus.triangles.row(2 * n) << n, next_i, next;
            torus.triangles.row(2 * n + 1) << n, next, next_j;
        }
    }
    return torus;
}

std::vector<Vec3> ring(int count, double R) {
    std::vector<Vec3> centers;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        centers.emplace_back(R * std::cos(angle), R * std::sin(angle), 0);
    }
    return centers;
}

std::vector<std::pair<int, int>> closed_chain(int count) {
    std::vector<std::pair<int, int>> links;
    for (int i = 0; i < count; ++i) links.emplace_back(std::min(i, (i + 1) % count), std::max(i, (i + 1) % count));
    return links;
}

// --- spheres against the body ---

constexpr double grid_error = 0.005;  // of a share, on a grid of 1/128 of the size

TEST(ShapeQuality, ABallIsFilledByItself) {
    const ShapeQuality q = shape_quality(model_of(mesh::make_sphere({1, 2, 3}, 5, 5), {{1, 2, 3}}, 5));
    EXPECT_NEAR(q.covered, 1, grid_error);
    EXPECT_NEAR(q.outside, 0, grid_error);
    EXPECT_NEAR(q.coverage, 0, 1e-9);  // its vertices lie on the sphere
}

TEST(ShapeQuality, OfABoxOfTwoCubesBallsLeaveTheCorners) {
    const mesh::Surface box = mesh::make_box({0, 0, 0}, {20, 10, 10}, {4, 2, 2});
    skeleton::Model model = model_of(box, {{5, 5, 5}, {15, 5, 5}}, 5);
    const double ball = std::numbers::pi / 6;  // of its cube
    const ShapeQuality q = shape_quality(model);
    EXPECT_NEAR(q.covered, ball, grid_error);
    EXPECT_NEAR(q.outside, 0, grid_error);
    EXPECT_NEAR(q.coverage, 5 * (std::sqrt(3) - 1), 1e-9);
    EXPECT_NEAR(q.coverage_share, q.coverage / 20, 1e-12);

    // What a support holds is not asked for: here the first cube with all that is in it.
    model.supports = {mesh::BoxRegion{{-1, -1, -1}, {10, 11, 11}}};
    model.spheres.back().radius = 2.5;
    const ShapeQuality free = shape_quality(model);
    EXPECT_NEAR(free.covered, ball / 8, grid_error);
    EXPECT_NEAR(free.coverage, 5 * std::sqrt(3) - 2.5, 1e-9);
}

TEST(ShapeQuality, HalfOfABallOnAFaceIsOutside) {
    const mesh::Surface box = mesh::make_box({0, 0, 0}, {20, 20, 20}, {2, 2, 2});
    EXPECT_NEAR(shape_quality(model_of(box, {{10, 10, 20}}, 6)).outside, 0.5, 2 * grid_error);
}

// --- graph against the body ---

TEST(GraphQuality, ARingOfLinksIsTheHandleOfATorus) {
    const GraphQuality q = graph_quality(model_of(make_torus(20, 6), ring(12, 20), 6, closed_chain(12)));
    EXPECT_EQ(q.body_parts, 1);
    EXPECT_EQ(q.parts, 1);
    EXPECT_EQ(q.body_handles, 1);
    EXPECT_EQ(q.loops, 1);
    EXPECT_EQ(q.handles, 1);
    EXPECT_EQ(q.links_outside, 0);
}

TEST(GraphQuality, AnOpenRingLacksTheHandle) {
    std::vector<std::pair<int, int>> links = closed_chain(12);
    links.pop_back();
    const GraphQuality q = graph_quality(model_of(make_torus(20, 6), ring(12, 20), 6, links));
    EXPECT_EQ(q.body_handles, 1);
    EXPECT_EQ(q.handles, 0);
}

TEST(GraphQuality, FewLinksRoundAHoleAreAHandleAndLeaveTheBody) {
    const GraphQuality q = graph_quality(model_of(make_torus(20, 4), ring(4, 20), 4, closed_chain(4)));
    EXPECT_EQ(q.handles, 1);
    EXPECT_EQ(q.links_outside, 4);
}

TEST(GraphQuality, MeshesOfAPlateAreNoHandles) {
    std::vector<Vec3> centers;
    std::vector<std::pair<int, int>> links;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            const int n = 3 * j + i;
            centers.emplace_back(5 + 10 * i, 5 + 10 * j, 2);
            if (i < 2) links.emplace_back(n, n + 1);
            if (j < 2) links.emplace_back(n, n + 3);
        }
    }
    links.emplace_back(0, 4);  // one mesh of four is two of three
    const mesh::Surface plate = mesh::make_box({0, 0, 0}, {30, 30, 4}, {6, 6, 1});
    const GraphQuality q = graph_quality(model_of(plate, centers, 2, links));
    EXPECT_EQ(q.loops, 5);
    EXPECT_EQ(q.handles, 0);
    EXPECT_EQ(q.body_handles, 0);
}

TEST(GraphQuality, CountsPartsOfBodyAndGraphApart) {
    mesh::Surface two = mesh::make_box({0, 0, 0}, {10, 10, 10}, {1, 1, 1});
    const mesh::Surface other = mesh::make_box({20, 0, 0}, {30, 10, 10}, {1, 1, 1});
    const Eigen::Index n = two.vertices.rows(), m = two.triangles.rows();
    two.vertices.conservativeResize(2 * n, 3);
    two.vertices.bottomRows(n) = other.vertices;
    two.triangles.conservativeResize(2 * m, 3);
    two.triangles.bottomRows(m) = other.triangles.array() + static_cast<int>(n);
    const GraphQuality q = graph_quality(model_of(two, {{3, 5, 5}, {7, 5, 5}, {25, 5, 5}}, 2, {{0, 1}, {1, 2}}));
    EXPECT_EQ(q.body_parts, 2);
    EXPECT_EQ(q.parts, 1);
    EXPECT_EQ(q.links_outside, 1);
}

// --- errors ---

TEST(ErrorSummary, TellsRmsMedianPercentileAndPooledAtEqualForce) {
    // relative errors 0.1, 0.2, 0.6; the last with a tenth of the displacement, at a tenth of the force
    const ErrorSummary s = summarise({{1, 10, 1}, {2, 10, 1}, {0.6, 1, 0.1}});
    EXPECT_EQ(s.probes, 3);
    EXPECT_NEAR(s.rms, std::sqrt((0.01 + 0.04 + 0.36) / 3), 1e-12);
    EXPECT_NEAR(s.median, 0.2, 1e-12);
    EXPECT_NEAR(s.p90, 0.2 + 0.8 * 0.4, 1e-12);
    EXPECT_NEAR(s.pooled, std::sqrt((1 + 4 + 36) / 300.), 1e-12);
}

// --- a small box ---

class QualityOfABox : public ::testing::Test {
protected:
    commands::SkeletonOptions options(const std::vector<int>& spheres) const {
        mesh::write_surface(scratch_ / "bar.stl", mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2}));
        commands::SkeletonOptions result{
            .input = scratch_ / "bar.stl", .output = scratch_ / "arm.json", .overrides = {}};
        result.overrides.set("volume.edge_length", 10);
        result.quality = QualityOptions{.spheres = spheres, .fit = 12, .held_out = 4};
        return result;
    }
    std::string text(const std::string& file) const { return mesh::read_text(scratch_ / file); }

    const TemporaryFolder scratch_;
};

TEST_F(QualityOfABox, IsWrittenBesideTheModel) {
    const commands::Outcome outcome = commands::skeleton(options({3, 6}), {});
    const json quality = json::parse(text("arm_quality.json"));
    EXPECT_EQ(quality["format"], "palpate-quality/1");
    ASSERT_EQ(quality["rungs"].size(), 3U);  // and the model itself
    int own = 0, before = 0;
    for (const json& step : quality["rungs"]) {
        own += step["own"].get<bool>();
        EXPECT_GE(step["spheres"], before);
        before = step["spheres"];
        EXPECT_EQ(step["held_out_probes"], 4);
        EXPECT_EQ(step["components"], 1);
        EXPECT_EQ(step["handles"], 0);
        // A fitted chain follows a short bar in most probes: far from nothing, and from all.
        EXPECT_GT(step["error"]["median"], 0);
        EXPECT_LT(step["error"]["median"], 0.5);
    }
    EXPECT_EQ(own, 1);
    EXPECT_EQ(outcome.json["quality"], quality);
    EXPECT_THAT(outcome.text, HasSubstr("arm_quality"));
    EXPECT_THAT(text("arm_quality.csv"), HasSubstr("own,spheres,held"));
    EXPECT_THAT(text("arm_quality.svg"), StartsWith("<svg"));

    // Files of its own it replaces.
    EXPECT_NO_THROW(commands::skeleton(options({}), {}));
}

TEST_F(QualityOfABox, RefusesStepsWithoutSpheresAndFilesOfOthers) {
    EXPECT_THAT(
        [&] {
            commands::skeleton(options({8, 0}), {});
        },
        ::testing::ThrowsMessage<InvalidInput>(HasSubstr("spheres of a quality step: 0; allowed are 1 to 20000")));
    mesh::write_text(scratch_ / "arm_quality.csv", "a table of mine\n");
    EXPECT_THAT([&] { commands::skeleton(options({8}), {}); },
                ::testing::ThrowsMessage<InvalidInput>(HasSubstr("arm_quality.csv: exists")));
    EXPECT_FALSE(fs::exists(scratch_ / "arm.json"));
}

TEST(QualityProbes, AreOthersForTheFitAndForTheJudgement) {
    Subject subject;
    subject.surface = mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2});
    subject.supports = {mesh::BoxRegion{{-1, -1, -1}, {3, 21, 21}}};
    subject.settings.edge_length = 10;
    const ProbedQuality probed = probe_for_quality(subject, {.fit = 9, .held_out = 5});
    std::set<int> probes;
    std::size_t loaded = 0;
    for (const identify::MeasurementSet* set : {&probed.fit, &probed.held_out}) {
        for (const identify::LoadState& state : set->states) {
            EXPECT_EQ(state.readings.size(), set->markers.size());
            if (state.contacts.empty()) continue;
            probes.insert(state.probe);
            ++loaded;
        }
    }
    EXPECT_EQ(loaded, 14U);
    EXPECT_EQ(probes.size(), 14U);
    EXPECT_GE(probed.held_out.markers.size(), probed.fit.markers.size());
}

}  // namespace
}  // namespace palpate::pipeline
