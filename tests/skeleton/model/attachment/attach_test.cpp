#include <gtest/gtest.h>

#include <map>

#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::add_link;
using testing::make_chain;
using testing::sphere_at;

using Carriers = std::map<int, double>;

Carriers carriers(const Attachment& at) {
    Carriers result;
    for (const SphereInfluence& share : at.shares) result[share.sphere] = share.weight;
    return result;
}

TEST(Attach, FallsPlumbOnTheLinksAxis) {
    const Attachment at = attach(make_chain(3), {12.5, 3, 4});
    EXPECT_EQ(carriers(at), (Carriers{{1, 0.75}, {2, 0.25}}));
    EXPECT_EQ(at.rest, Vec3(12.5, 3, 4));
}

TEST(Attach, EndsAtTheLastSphere) {
    const Attachment at = attach(make_chain(3), {34, 1, 0});
    EXPECT_EQ(carriers(at), (Carriers{{3, 1}}));
}

TEST(Attach, TiesGoToTheLowerLink) {
    const Attachment at = attach(make_chain(3), {10, 3, 0});
    EXPECT_EQ(carriers(at), (Carriers{{1, 1}}));
}

TEST(Attach, AThickSphereKeepsItsSkin) {
    Model model = make_chain(1);
    model.spheres.push_back(sphere_at({5, 30, 0}));
    model.spheres.back().radius = 20;
    // 12 mm above the thin link, 8 mm from its surface; inside the thick sphere.
    const Attachment at = attach(model, {5, 12, 0});
    EXPECT_EQ(carriers(at), (Carriers{{2, 1}}));
}

TEST(Attach, RadiusRunsAlongTheLink) {
    Model model;
    for (const double y : {0.0, 20.0})
        for (const double x : {0.0, 40.0}) model.spheres.push_back(sphere_at({x, y, 0}));
    model.spheres[0].radius = 8;
    model.spheres[1].radius = 2;
    model.spheres[2].radius = 2;
    model.spheres[3].radius = 8;
    add_link(model, 0, 1, Vec3::Ones());
    add_link(model, 2, 3, Vec3::Ones());
    // Half way between two cones: the thick end of each draws the point.
    EXPECT_EQ(attach(model, {5, 10, 0}).shares[0].sphere, 0);
    EXPECT_EQ(attach(model, {35, 10, 0}).shares[0].sphere, 2);
}

TEST(Attach, AMarkerThatStandsOffHangsWhereItIsFixed) {
    const Attachment at = attach(make_chain(3), {5, 4, 0}, {25, 30, 0});
    EXPECT_EQ(carriers(at), (Carriers{{0, 0.5}, {1, 0.5}}));
    EXPECT_EQ(at.rest, Vec3(25, 30, 0));
}

}  // namespace
}  // namespace palpate::skeleton
