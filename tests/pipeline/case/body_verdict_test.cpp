// Which surfaces are of a body, before anything is done with them.

#include "pipeline/case/body_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/commands.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

mesh::Surface box(const Vec3& low, const Vec3& high) { return mesh::make_box(low, high, {4, 2, 2}); }

mesh::Surface together(const mesh::Surface& one, const mesh::Surface& other) {
    mesh::Surface both = one;
    const Eigen::Index vertices = one.vertices.rows(), triangles = one.triangles.rows();
    both.vertices.conservativeResize(vertices + other.vertices.rows(), 3);
    both.vertices.bottomRows(other.vertices.rows()) = other.vertices;
    both.triangles.conservativeResize(triangles + other.triangles.rows(), 3);
    both.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + static_cast<int>(vertices);
    return both;
}

const mesh::Surface whole_bar = box({0, 0, 0}, {100, 20, 10});
const mesh::Surface second_piece = box({0, 40, 0}, {60, 60, 10}), crumb = box({0, 40, 0}, {2, 42, 2});

TEST(KeepPieces, CrumbsAreLeftOutAloud) {
    const KeptSurface kept = keep_pieces(together(crumb, whole_bar), KeptPieces::automatic);
    EXPECT_EQ(kept.surface.vertices.rows(), whole_bar.vertices.rows());
    EXPECT_EQ(kept.surface.triangles.rows(), whole_bar.triangles.rows());
    EXPECT_EQ(mesh::bounding_box(kept.surface.vertices).max, Vec3(100, 20, 10));
    EXPECT_THAT(kept.notes, testing::ElementsAre(AllOf(HasSubstr("2 x 2 x 2 mm"), HasSubstr("--keep all"))));
    EXPECT_EQ(kept.refusal, "");
}

TEST(KeepPieces, TwoThatCountAreAskedAbout) {
    const mesh::Surface both = together(whole_bar, second_piece);
    EXPECT_THAT(keep_pieces(both, KeptPieces::automatic).refusal,
                AllOf(HasSubstr("2 pieces that do not touch"), HasSubstr("100 x 20 x 10 mm"),
                      HasSubstr("60 x 20 x 10 mm"), HasSubstr("--keep largest")));
    const KeptSurface largest = keep_pieces(both, KeptPieces::largest);
    EXPECT_EQ(largest.refusal, "");
    EXPECT_EQ(largest.surface.triangles.rows(), whole_bar.triangles.rows());
    EXPECT_EQ(largest.notes.size(), 1U);
    const KeptSurface all = keep_pieces(both, KeptPieces::all);
    EXPECT_EQ(all.refusal, "");
    EXPECT_EQ(all.surface.triangles.rows(), both.triangles.rows());
}

TEST(KeepPieces, WhatLiesWithinOrCrossesIsOfTheBody) {
    for (const mesh::Surface& other : {box({10, 5, 2}, {90, 15, 8}), box({90, 5, 2}, {120, 15, 8})}) {
        const KeptSurface kept = keep_pieces(together(whole_bar, other), KeptPieces::automatic);
        EXPECT_EQ(kept.refusal, "");
        EXPECT_THAT(kept.notes, IsEmpty());
        EXPECT_EQ(kept.surface.triangles.rows(), whole_bar.triangles.rows() + other.triangles.rows());
    }
}

TEST(RefusalOfFlat, ASheetIsNoBodyHoweverItIsTurned) {
    mesh::Surface sheet = box({0, 0, 0}, {100, 20, 1e-9});
    EXPECT_THAT(refusal_of_flat(sheet), AllOf(HasSubstr("is flat"), HasSubstr("100 mm long")));
    const Mat3 turn = (Mat3() << 0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6).finished();
    sheet.vertices = sheet.vertices * turn;
    EXPECT_THAT(refusal_of_flat(sheet), HasSubstr("is flat"));
    EXPECT_EQ(refusal_of_flat(box({0, 0, 0}, {100, 20, 0.1})), "") << "foil";
}

/// One verdict in both commands, and nothing is begun.
TEST(BodyVerdict, CheckTellsWhatRunRefuses) {
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "two.stl", together(whole_bar, second_piece));
    const commands::Outcome told = commands::check({.input = scratch / "two.stl", .overrides = {}}, {});
    EXPECT_EQ(told.code, commands::bad_input);
    EXPECT_THAT(told.text, AllOf(HasSubstr("It cannot be run:"), HasSubstr("2 pieces that do not touch"),
                                 Not(HasSubstr("Next:")), Not(HasSubstr("is sound"))));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] {
                         commands::run({.input = scratch / "two.stl", .output = scratch / "run", .overrides = {}}, {});
                     }),
                     {"two.stl", "2 pieces that do not touch", "--keep largest"}));
    EXPECT_FALSE(std::filesystem::exists(scratch / "run"));

    commands::CheckOptions largest{.input = scratch / "two.stl", .overrides = {}};
    largest.overrides.set("keep", "largest");
    EXPECT_THAT(commands::check(largest, {}).text, AllOf(HasSubstr("is left out"), HasSubstr("Next: palpate run")));
}

/// The cause is said, not what follows of it, and nothing is assumed of a body that there is not.
TEST(BodyVerdict, AStrayVertexIsNamed) {
    const TemporaryFolder scratch;
    mesh::Surface strayed = whole_bar;
    strayed.vertices.row(0) = Vec3(1e9, 1e9, 1e9).transpose();
    mesh::write_surface(scratch / "strayed.obj", strayed);
    const commands::Outcome told = commands::check({.input = scratch / "strayed.obj", .overrides = {}}, {});
    EXPECT_EQ(told.code, commands::bad_input);
    EXPECT_THAT(told.text, AllOf(HasSubstr("One vertex at (1e+09, 1e+09, 1e+09) mm lies far from the other"),
                                 HasSubstr("which span 100 x 20 x 10 mm"), Not(HasSubstr("is flat")),
                                 Not(HasSubstr("assumed")), Not(HasSubstr("Held by"))));
    // not far enough to make it flat, and still a slip
    strayed.vertices.row(0) = Vec3(1e5, 0, 0).transpose();
    mesh::write_surface(scratch / "spike.obj", strayed);
    EXPECT_THAT(commands::check({.input = scratch / "spike.obj", .overrides = {}}, {}).text,
                HasSubstr("One vertex at (1e+05, 0, 0) mm lies far"));
}

TEST(BodyVerdict, ASizeThatIsASlipOfUnitsIsSaid) {
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "small.stl", box({0, 0, 0}, {0.8, 0.2, 0.1}));
    EXPECT_THAT(commands::check({.input = scratch / "small.stl", .overrides = {}}, {}).text,
                AllOf(HasSubstr("0.8 mm at its longest, smaller than"), HasSubstr("in m or cm?")));
}

}  // namespace
}  // namespace palpate::pipeline
