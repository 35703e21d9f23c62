#include "pipeline/body/contact_zones.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/topology/check_surface.h"
#include "pipeline/body/body.h"
#include "pipeline/body/meshes_under_tools.h"

namespace palpate::pipeline {
namespace {

/// A block of 60 x 60 x 30 mm with a ball of 5 mm on it, and a punch of 3 mm beside it.
identify::MeasurementSet block() {
    identify::MeasurementSet set;
    set.rest_surface = mesh::make_box({0, 0, 0}, {60, 60, 30}, {1, 1, 1});
    set.tools = {{.name = "ball", .shape = mesh::SphereShape{5}, .origin = Vec3(30, 30, 35)},
                 {.name = "punch", .shape = mesh::FlatShape{3, Vec3(0, 0, -1)}, .origin = Vec3(15, 15, 30)},
                 {.name = "grip", .shape = mesh::GripShape{}, .bonded = true}};
    return set;
}

identify::LoadState moved(int probe, int tool, const Vec3& by) {
    identify::LoadState state;
    state.probe = probe;
    state.motions = {{.tool = tool, .translation = by}};
    return state;
}

TEST(ContactZones, AreWhereToolsTouchAndAsWideAsTheirContacts) {
    identify::MeasurementSet set = block();
    set.states = {moved(1, 0, Vec3(0, 0, -1.25)), moved(2, 1, Vec3(0, 0, -1)), moved(3, 0, Vec3(0, 0, 1)),
                  moved(4, 2, Vec3(0, 0, 1)), moved(5, 0, Vec3(0, 0, -1.26))};
    const std::vector<FineZone> zones = contact_zones(set);
    ASSERT_EQ(zones.size(), 2U);  // the ball away from the body, the grip, and what is the same again make none
    EXPECT_LT((zones[0].at - Vec3(30, 30, 30)).norm(), 1e-9);
    EXPECT_NEAR(zones[0].radius, 1.3 * std::sqrt(5 * 1.25), 1e-9);  // Hertz
    EXPECT_NEAR(zones[1].radius, 1.3 * 3, 1e-9);
    EXPECT_NEAR(zones[0].edge / zones[1].edge, std::sqrt(5 * 1.25) / 3, 1e-9);
    EXPECT_EQ(edge_at(Vec3(30, 30, 30), zones, 4), zones[0].edge);
    EXPECT_EQ(edge_at(Vec3(60, 60, 0), zones, 4), 4);
}

TEST(ContactZones, OfManyPlacesHaveLongerEdges) {
    identify::MeasurementSet set = block();
    for (int i = 0; i < 20; ++i) set.states.push_back(moved(i, 0, Vec3(i - 10, 0, -1.25)));
    const std::vector<FineZone> zones = contact_zones(set);
    ASSERT_EQ(zones.size(), 20U);
    EXPECT_GT(zones[0].edge, 2 * std::sqrt(5 * 1.25) / 2.5);
}

TEST(MeshesUnderTools, AreMadeOncePerPlaceAndFinerThere) {
    identify::MeasurementSet set = block();
    set.states = {moved(1, 0, Vec3(0, 0, -0.5)), moved(1, 0, Vec3(0, 0, -1.25)), moved(2, 0, Vec3(15, 15, -1))};
    MeshesUnderTools meshes(set, {.edge_length = 8});
    const identify::FinerMesh shallow = meshes.at(set.states[0].motions), deep = meshes.at(set.states[1].motions),
                              elsewhere = meshes.at(set.states[2].motions);
    ASSERT_TRUE(deep.mesh && elsewhere.mesh);
    EXPECT_EQ(shallow.mesh, deep.mesh) << "one place";
    EXPECT_NE(elsewhere.mesh, deep.mesh);
    EXPECT_NEAR(deep.times, 8 / (std::sqrt(5 * 1.25) / 2.5), 1e-6);
    const auto count_near = [](const mesh::VolumeMesh& mesh, const Vec3& place) {
        return ((mesh.nodes.rowwise() - place.transpose()).rowwise().norm().array() < 4).count();
    };
    EXPECT_GT(count_near(*deep.mesh, Vec3(30, 30, 30)), 10 * count_near(*deep.mesh, Vec3(45, 45, 30)));
    EXPECT_FALSE(meshes.at(moved(3, 0, Vec3(0, 0, 1)).motions).mesh) << "it does not touch";
    EXPECT_FALSE(meshes.at(moved(3, 0, Vec3(-15, 0, -1)).motions).mesh) << "no state of the set is there";

    MeshesUnderTools hardly(set, {.edge_length = 8, .fine = contact_zones(set)});
    EXPECT_FALSE(hardly.at(set.states[1].motions).mesh) << "the other mesh is as fine there";
}

TEST(ContactZones, MakeABodyWithShortEdgesThere) {
    identify::MeasurementSet set = block();
    set.states = {moved(1, 0, Vec3(0, 0, -1.25))};
    const MeshedBody coarse = make_body(set.rest_surface, {.edge_length = 6});
    const MeshedBody fine = make_body(set.rest_surface, {.edge_length = 6, .fine = contact_zones(set)});
    EXPECT_TRUE(mesh::check_surface(fine.surface).sound());
    const auto near = [](const MeshedBody& body) {
        int count = 0;
        for (const auto& x : body.surface.vertices.rowwise())
            count += (x.transpose() - Vec3(30, 30, 30)).norm() < 2.5 ? 1 : 0;
        return count;
    };
    EXPECT_LT(near(coarse), 5);
    EXPECT_GT(near(fine), 20);
    EXPECT_LT(fine.volume.nodes.rows(), coarse.volume.nodes.rows() + 6000);
}

}  // namespace
}  // namespace palpate::pipeline
