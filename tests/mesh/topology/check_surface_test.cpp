#include "mesh/topology/check_surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/mesh/faulty_surfaces.h"
#include "tests/messages.h"

namespace palpate::mesh {
namespace {

TEST(CheckSurface, SoundBodiesHaveNoFaults) {
    for (const Surface& surface : {cube(), unwelded(cube()), hollow_ball(), make_sphere({5, 5, 5}, 1, 2)}) {
        const SurfaceReport report = check_surface(surface);
        EXPECT_TRUE(report.sound());
        EXPECT_TRUE(describe_faults(report).empty());
    }
    const SurfaceReport report = check_surface(unwelded(cube()));
    EXPECT_EQ(report.duplicate_vertices, 3 * 192 - 98);  // 192 triangles, 98 corners
    EXPECT_NEAR(report.volume, 1000, 1e-9);              // round-off of some hundred terms
    EXPECT_NEAR(report.area, 600, 1e-9);
}

TEST(CheckSurface, CountsAHole) {
    const SurfaceReport report = check_surface(without_triangle(cube(), 7));
    EXPECT_EQ(report.boundary_edges, 3);
    EXPECT_EQ(report.holes, 1);
    EXPECT_FALSE(report.closed);
    EXPECT_FALSE(report.sound());
    EXPECT_EQ(check_surface(open_sheet()).holes, 1);
}

TEST(CheckSurface, CountsTwinsSliversAndFlippedTriangles) {
    EXPECT_EQ(check_surface(with_twin(cube())).duplicate_triangles, 1);
    EXPECT_FALSE(check_surface(with_twin(cube())).sound());
    EXPECT_EQ(check_surface(with_triangle(cube(), 0, 1, 1)).degenerate_triangles, 1);
    EXPECT_FALSE(check_surface(with_triangle(cube(), 0, 1, 1)).sound());
    EXPECT_EQ(check_surface(with_flipped_triangle(cube())).inconsistent_edges, 3);
    EXPECT_FALSE(check_surface(with_flipped_triangle(cube())).sound());
}

TEST(CheckSurface, CountsWhatIsNoManifold) {
    EXPECT_EQ(check_surface(with_fin(cube())).non_manifold_edges, 1);
    EXPECT_FALSE(check_surface(with_fin(cube())).sound());
    EXPECT_EQ(check_surface(bow_tie()).non_manifold_vertices, 1);
    EXPECT_FALSE(check_surface(bow_tie()).sound());
}

TEST(CheckSurface, CountsCrossings) {
    EXPECT_GT(check_surface(with_spike(cube())).self_intersections, 0);
    EXPECT_GT(check_surface(join(cube(), make_sphere({10, 5, 5}, 3, 2))).self_intersections, 0);
    EXPECT_EQ(check_surface(join(cube(), make_sphere({20, 5, 5}, 3, 2))).self_intersections, 0);
    EXPECT_EQ(check_surface(join(cube(), make_sphere({20, 5, 5}, 3, 2))).components, 2);
}

TEST(CheckSurface, TellsWhereFaultsAreByTheRowsOfTheSurfaceGiven) {
    std::vector<FaultPlace> places;
    const auto count = [&](const Surface& surface, Fault fault) {
        places.clear();
        check_surface(surface, &places);
        return std::count_if(places.begin(), places.end(), [&](auto& place) { return place.fault == fault; });
    };
    EXPECT_EQ(count(cube(), Fault::hole), 0);
    EXPECT_TRUE(places.empty());
    // The twin comes last; that it is dropped moves no row before it.
    EXPECT_EQ(count(with_twin(cube()), Fault::duplicate_triangle), 1);
    EXPECT_EQ(places[0].triangles, std::vector<int>{192});
    EXPECT_EQ(count(with_triangle(cube(), 0, 1, 1), Fault::degenerate_triangle), 1);
    EXPECT_EQ(count(without_triangle(cube(), 7), Fault::hole), 3);
    EXPECT_EQ(count(with_flipped_triangle(cube()), Fault::inconsistent_edge), 3);
    EXPECT_EQ(places[0].triangles.size(), 2u);
    EXPECT_EQ(count(with_fin(cube()), Fault::non_manifold_edge), 1);
    EXPECT_EQ(places[0].triangles.size(), 3u);
    EXPECT_EQ(count(bow_tie(), Fault::non_manifold_vertex), 1);
    EXPECT_EQ(places[0].at, Vec3(0, 0, 0));
    const Surface both = join(cube(), make_sphere({10, 5, 5}, 3, 2));
    EXPECT_EQ(count(both, Fault::self_intersection), check_surface(both).self_intersections);
    for (const FaultPlace& place : places) {
        EXPECT_NEAR((place.at - Vec3(10, 5, 5)).norm(), 3, 2) << "where the ball meets the side, within a triangle";
        EXPECT_TRUE(place.triangles[0] < 192 && place.triangles[1] >= 192);
    }
}

TEST(CheckSurface, BodiesLookOutAndCavitiesIn) {
    EXPECT_FALSE(check_surface(inside_out(cube())).outward);
    EXPECT_FALSE(check_surface(join(make_sphere({0, 0, 0}, 10, 2), make_sphere({0, 0, 0}, 5, 2))).sound());
    EXPECT_TRUE(check_surface(hollow_ball()).sound());
}

TEST(CheckSurface, SaysEachFaultInWords) {
    const auto faults = [](const Surface& surface) {
        std::string all;
        for (const std::string& fault : describe_faults(check_surface(surface))) all += fault + "\n";
        return all;
    };
    EXPECT_TRUE(says(faults(without_triangle(cube(), 7)), {"1 hole", "3 open edges", "fills"}));
    EXPECT_TRUE(says(faults(with_twin(cube())), {"1 triangle", "twice"}));
    EXPECT_TRUE(says(faults(with_triangle(cube(), 0, 1, 1)), {"1 triangle", "without area"}));
    EXPECT_TRUE(says(faults(with_flipped_triangle(cube())), {"3 edge", "outside"}));
    EXPECT_TRUE(says(faults(with_fin(cube())), {"1 edge", "more than two triangles"}));
    EXPECT_TRUE(says(faults(bow_tie()), {"1 vertex", "touch"}));
    EXPECT_TRUE(says(faults(with_spike(cube())), {"cross"}));
    EXPECT_TRUE(says(faults(inside_out(cube())), {"inside out", "-1000"}));
    EXPECT_TRUE(says(faults(Surface{Points(0, 3), Triangles(0, 3)}), {"No triangles"}));
}

}  // namespace
}  // namespace palpate::mesh
