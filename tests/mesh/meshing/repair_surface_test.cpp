#include "mesh/meshing/repair_surface.h"

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/geometry/winding.h"
#include "mesh/meshing/repair/guarded.h"
#include "mesh/system/bytes.h"
#include "mesh/topology/check_surface.h"
#include "tests/mesh/faulty_surfaces.h"
#include "tests/messages.h"

namespace palpate::mesh {
namespace {

/// Sound, and as large as it should be.
void expect_mended(const Surface& faulty, double volume, double tolerance) {
    const RepairResult mended = repair_surface(faulty);
    EXPECT_TRUE(check_surface(mended.surface).sound());
    EXPECT_FALSE(mended.steps.empty());
    EXPECT_NEAR(mended.volume, volume, tolerance * volume);
    EXPECT_DOUBLE_EQ(mended.volume, signed_volume(mended.surface));
}

TEST(RepairSurface, ASoundSurfaceComesBackUnchanged) {
    const RepairResult same = repair_surface(hollow_ball());
    EXPECT_TRUE(same.steps.empty());
    EXPECT_EQ(same.distance, 0);
    EXPECT_EQ(same.surface.triangles.rows(), hollow_ball().triangles.rows());
    EXPECT_DOUBLE_EQ(same.volume, signed_volume(hollow_ball()));
}

TEST(RepairSurface, AVertexFarAwayIsNamed) {
    Surface stray = cube();
    const int moved = stray.triangles(0, 0);
    stray.vertices.row(moved) = Eigen::RowVector3d(0, 1e9, 0);
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { repair_surface(stray); }),
             {("vertex " + std::to_string(moved + 1) + " ").c_str(), "1e+09", "so far away", "Move or remove it"}));
    Surface line = cube();
    line.vertices.rightCols<2>().setZero();
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { repair_surface(line); }), {"no triangle", "area"}));
}

TEST(RepairSurface, WeldingIsSaid) {
    const RepairResult welded = repair_surface(unwelded(cube()));
    EXPECT_EQ(welded.surface.vertices.rows(), cube().vertices.rows());
    ASSERT_EQ(welded.steps.size(), 1u);
    EXPECT_TRUE(says(welded.steps[0], {"478 corners", "welded"}));  // 3 x 192 - 98
}

TEST(RepairSurface, MendsEachFault) {
    // These leave the shape as it was: round-off only.
    expect_mended(without_triangle(cube(), 7), 1000, 1e-12);
    expect_mended(with_twin(cube()), 1000, 1e-12);
    expect_mended(with_triangle(cube(), 0, 1, 1), 1000, 1e-12);
    expect_mended(with_flipped_triangle(cube()), 1000, 1e-12);
    expect_mended(inside_out(cube()), 1000, 1e-12);
    expect_mended(join(make_sphere({0, 0, 0}, 10, 3), make_sphere({0, 0, 0}, 5, 2)), signed_volume(hollow_ball()),
                  1e-12);
}

TEST(RepairSurface, SmallFinsAreDroppedAndLargeOnesAreNoBody) {
    const Surface fin = with_fin(cube());
    expect_mended(fin, 1000, 1e-12);  // round-off
    const RepairResult repaired = repair_surface(fin);
    EXPECT_FALSE(repaired.wrapped);
    EXPECT_TRUE(says(repaired.steps[0], {"fins", "1 edges"}));
    // Ten times as high it has 2 % of the area: somebody may have meant it.
    Surface large = fin;
    const Eigen::Index top = large.vertices.rows() - 1;
    large.vertices.row(top) += 9 * (large.vertices.row(top) - large.vertices.row(large.triangles(0, 0)));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { repair_surface(large); }), {"skin", "open sheet"}));
}

TEST(RepairSurface, OverlappingPartsAreUnited) {
    const Surface other = make_box({5, 2, 2}, {15, 8, 8}, {2, 2, 2});
    const RepairResult united = repair_surface(join(cube(), other));
    EXPECT_FALSE(united.wrapped);
    EXPECT_NEAR(united.volume, 1000 + 5 * 36, 1e-9);  // round-off of constructed corners
}

TEST(RepairSurface, PartsThatStandApartAreKept) {
    const RepairResult kept = repair_surface(unwelded(join(cube(), make_sphere({20, 5, 5}, 3, 2))));
    EXPECT_EQ(check_surface(kept.surface).components, 2);
}

TEST(RepairSurface, ASpikeThroughTheBodyIsCutOut) {
    RepairOptions options;
    options.allowed_distance = 1;  // the spike's tip is lost
    const RepairResult mended = repair_surface(with_spike(cube()), options);
    EXPECT_TRUE(check_surface(mended.surface).sound());
    EXPECT_GT(mended.volume, 900);  // the cube is 1000, less what the spike's cut takes
}

TEST(RepairSurface, RefusesWhatEnclosesNothing) {
    EXPECT_TRUE(says(message_of<InvalidInput>([] { repair_surface(open_sheet()); }), {"encloses no volume"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { repair_surface(join(open_sheet(), inside_out(open_sheet()))); }),
                     {"encloses no volume"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] {
                         repair_surface(Surface{Points(0, 3), Triangles(0, 3)});
                     }),
                     {"no triangles"}));
}

TEST(RepairSurface, RefusesAHoleThatIsTooLarge) {
    // The cube without one side: a hole of 14 mm where the diagonal is 17 mm.
    const Surface whole = cube();
    Surface cup{whole.vertices, Triangles(0, 3)};
    for (const auto& t : whole.triangles.rowwise())
        if (whole.vertices(t[0], 2) + whole.vertices(t[1], 2) + whole.vertices(t[2], 2) < 30)
            cup = with_triangle(cup, t[0], t[1], t[2]);
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { repair_surface(cup); }), {"encloses no volume", "25 %", "close them"}));
    RepairOptions options;
    options.largest_hole = 1;
    EXPECT_NEAR(repair_surface(cup, options).volume, 1000, 1e-9);  // the lid is flat
}

TEST(RepairSurface, RefusesAResultThatStrays) {
    // One corner lies 0.03 mm off its twins, and welding brings them together.
    Surface torn = unwelded(cube());
    torn.vertices.row(0).array() += 0.02;
    RepairOptions options;
    options.weld = 0.005;
    options.allowed_distance = 1e-9;
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { repair_surface(torn, options); }), {"lies", "allowed", "After:"}));
}

TEST(RepairSurface, RefusesWhatIsNoNumberOrNoVertex) {
    Surface surface = cube();
    surface.vertices(5, 1) = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { repair_surface(surface); }), {"vertex 5", "not finite"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([] { repair_surface(with_triangle(cube(), 0, 1, 98)); }),
                     {"vertex 98", "0 to 97"}));
}

TEST(RepairSurface, OptionsNameTheirBounds) {
    const auto refusal = [](const RepairOptions& options) {
        return message_of<InvalidInput>([&] { options.validate(); });
    };
    EXPECT_TRUE(says(refusal({.weld = 0}), {"weld", "0.01"}));
    EXPECT_TRUE(says(refusal({.largest_hole = 2}), {"largest_hole", "2"}));
    EXPECT_TRUE(says(refusal({.allowed_distance = 0}), {"allowed_distance", "0"}));
}

TEST(RepairSurface, ABodyWithAnOpenSheetToItIsRefused) {
    // A box without a lid, too wide to be closed, through whose bottom a ball sticks: a wrap would be a ball with a
    // skin.
    const Surface whole = cube();
    Surface box{whole.vertices, Triangles(0, 3)};
    for (const auto& t : whole.triangles.rowwise())
        if (whole.vertices(t[0], 2) < 10 || whole.vertices(t[1], 2) < 10 || whole.vertices(t[2], 2) < 10)
            box = with_triangle(box, t[0], t[1], t[2]);
    const Surface both = join(box, make_sphere({5, 5, 0}, 4, 3));
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { repair_surface(both); }), {"% of what can be wrapped", "skin", "mm"}));
}

TEST(RepairSurface, WhatWasDoneEndsWithVolumeAndDistance) {
    const RepairResult repaired = repair_surface(with_flipped_triangle(cube()));
    EXPECT_TRUE(says(repaired.steps.back(), {"encloses 1000 mm^3", "lies within 0 mm"}));
}

TEST(RepairSurface, ALargeFlatHoleIsClosedByAPlane) {
    // A box of 20 x 10 x 10 without the side x = 0, of 14.1 mm across; its diagonal is 24.5 mm.
    const Surface whole = make_box({0, 0, 0}, {20, 10, 10}, {4, 2, 2});
    Surface open{whole.vertices, Triangles(0, 3)};
    for (const auto& t : whole.triangles.rowwise())
        if (whole.vertices(t[0], 0) > 0 || whole.vertices(t[1], 0) > 0 || whole.vertices(t[2], 0) > 0)
            open = with_triangle(open, t[0], t[1], t[2]);
    const RepairResult repaired = repair_surface(open);
    EXPECT_NEAR(repaired.volume, 2000, 1e-9);  // round-off
    EXPECT_FALSE(repaired.wrapped);
    EXPECT_TRUE(says(repaired.steps[0], {"1 flat holes", "planes"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { repair_surface(open, {.largest_flat_hole = 2}); }),
                     {"largest_flat_hole is 2", "0 to 1"}));
}

TEST(RepairSurface, AWrapIsMadeOfASoundSurfaceWhereItIsAskedFor) {
    const RepairResult repaired = repair_surface(cube(), {.wrap = true});
    EXPECT_TRUE(repaired.wrapped);
    EXPECT_NEAR(repaired.volume, 1000, 600 * 0.0005 * 17.32);  // of 600 mm^2, an offset of 0.05 % of the diagonal
}

TEST(RepairSurface, AWrapThatFillsACavityIsRefused) {
    ASSERT_TRUE(check_surface(hollow_ball()).sound());
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { repair_surface(hollow_ball(), {.wrap = true}); }),
                     {"% of what can be wrapped", "lies outside", "cavities"}));
}

TEST(WindingNumber, IsOneInsideZeroOutsideAndTheShareOfTheSphereSeenThroughAHole) {
    const Surface ball = make_sphere({1, 2, 3}, 10, 3);
    EXPECT_NEAR(winding_number(ball, {1, 2, 9}), 1, 1e-12);
    EXPECT_NEAR(winding_number(ball, {1, 2, 14}), 0, 1e-12);
    const Surface twice = join(ball, make_sphere({1, 2, 3}, 8, 3));
    EXPECT_NEAR(winding_number(twice, {1, 2, 9}), 2, 1e-12);
    Surface lower{ball.vertices, Triangles(0, 3)};
    for (const auto& t : ball.triangles.rowwise())
        if (ball.vertices(t[0], 2) + ball.vertices(t[1], 2) + ball.vertices(t[2], 2) < 3 * 3)
            lower = with_triangle(lower, t[0], t[1], t[2]);
    EXPECT_NEAR(winding_number(lower, {1, 2, 3}), 0.5, 0.02);  // half of the triangles, to within one row of them
}

TEST(ShareOutside, IsWhatACubeHasBeyondAnother) {
    const Surface outer = make_box({0, 0, 0}, {10, 10, 12.5}, {2, 2, 2});
    EXPECT_NEAR(share_outside(outer, cube(), 4000), 0.2, 0.02);  // three standard deviations
    EXPECT_EQ(share_outside(cube(), outer, 1000), 0);
}

TEST(Guarded, AStepThatCrashesThrowsOrLeavesNothingIsNone) {
    EXPECT_EQ(guarded(12, [] { return cube(); })->triangles, cube().triangles);
    EXPECT_FALSE(guarded(12, []() -> Surface { std::abort(); }));
    EXPECT_FALSE(guarded(12, []() -> Surface { throw SolverFailure("no"); }));
    EXPECT_FALSE(guarded(12, [] { return Surface{}; }));
}

TEST(Bytes, ComeBackWholeOrNotAtAll) {
    const std::string bytes = to_bytes(cube().vertices, cube().triangles);
    Surface back;
    from_bytes(bytes, back.vertices, back.triangles);
    EXPECT_EQ(back.vertices, cube().vertices);
    EXPECT_EQ(back.triangles, cube().triangles);
    for (const std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{16}, bytes.size() - 1})
        EXPECT_THROW(from_bytes(bytes.substr(0, size), back.vertices, back.triangles), cereal::Exception);
}

}  // namespace
}  // namespace palpate::mesh
