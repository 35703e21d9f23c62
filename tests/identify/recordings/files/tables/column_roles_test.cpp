#include <gtest/gtest.h>

#include "tests/identify/recordings/read_sample.h"

namespace palpate::identify {
namespace {

TEST(Tables, NamesAndUnitsTellPointsFromForces) {
    const Recording run = read_sample(
        "t,tip_x [cm],tip_y [cm],tip_z [cm],m2X [mm],m2Y [mm],Fx,Fy,Fz,load_x [N]\n"
        "0,1,2,3,4,5,6,7,8,9\n1,1,,3,4,5,6,7,8,9\n");
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[0].name, "tip");
    EXPECT_EQ(run.points[0].at.col(0), Eigen::Vector3d(10, 20, 30));
    EXPECT_EQ(run.points[1].at.col(0), Eigen::Vector3d(4, 5, 0));
    ASSERT_EQ(run.channels.size(), 4u);
    EXPECT_EQ(run.channels[3].name, "load_x");
}

TEST(Tables, NamesTellPointsInAPlane) {
    const Recording run = read_sample("time,a.x,a.y,b.x,b.y\n0,1,2,3,4\n1,5,6,7,\n");
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[1].name, "b");
    EXPECT_EQ(run.points[1].at.col(0), Eigen::Vector3d(3, 4, 0));
    EXPECT_TRUE(run.points[1].at.col(1).array().isNaN().all());
    EXPECT_TRUE(run.channels.empty());
}

TEST(Tables, NamesMayStandInTwoLines) {
    for (const char* groups : {"bodyparts,tip,tip,tip,base,base,base\n", ",tip,,,base,,\n"}) {
        const Recording run = read_sample("scorer,net,net,net,net,net,net\n" + std::string(groups) +
                                          "coords,x,y,likelihood,x,y,likelihood\n"
                                          "0,1,2,0.9,3,4,0.9\n1,5,6,0.9,7,8,0.9\n2,5,6,0.9,7,8,0.8\n");
        ASSERT_EQ(run.points.size(), 2u);
        EXPECT_EQ(run.points[1].name, "base");
        EXPECT_EQ(run.points[1].at.col(1), Eigen::Vector3d(7, 8, 0));
        ASSERT_EQ(run.channels.size(), 2u);
        EXPECT_EQ(run.channels[1].name, "base likelihood");
        EXPECT_TRUE(notes_tell(run, "line 2 names groups"));
    }
}

TEST(Tables, OfRosHaveTimesSince1970AndNoPointsOfOrientations) {
    const Recording run = read_sample(
        "%time,field.header.seq,field.pose.position.x,field.pose.position.y,field.pose.position.z,"
        "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n"
        "1700000000000000000,1,1,2,3,0,0,0,1\n1700000000250000000,2,4,5,6,0,0,0,1\n");
    EXPECT_NEAR(run.times[1] - run.times[0], 0.25, 2.4e-7);  // doubles of 1.7e9 s are 2^-22 s apart
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].name, "field.pose.position");
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(Tables, WithoutNamesAClockAndThreesAreGuessedAndSaid) {
    const Recording run = read_sample("0,0.000,1,2,3,4,5,6\n1,0.005,1,2,3,4,5,6\n2,0.010,1,2,3,4,5,7\n");
    EXPECT_DOUBLE_EQ(run.times[2], 0.01);
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[1].at(2, 2), 7);
    EXPECT_TRUE(notes_tell(run, "2 points"));
    EXPECT_TRUE(notes_tell(run, "no unit of positions is given"));
}

TEST(Tables, PosesAreNamedByPositionAndQuaternion) {
    const Recording run =
        read_sample("time\ttip-px\ttip-py\ttip-pz\ttip-qx\ttip-qy\ttip-qz\n0\t1\t2\t3\t0\t0\t1\n1\t4\t5\t6\t0\t0\t1\n");
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].name, "tip");
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(Tables, ComponentsInBracketsAreCoordinates) {
    const Recording run = read_sample(
        "Time,C7[0],C7[1],C7[2],C7[3],F[N],strain [1]\n0,1,2,3,1,5,0\n0.1,1,2,4,1,6,0.1\n0.2,1,2,5,1,7,0.2\n");
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].name, "C7");
    EXPECT_EQ(run.points[0].at.col(2), Eigen::Vector3d(1, 2, 5));
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[0].unit, "N");
    EXPECT_EQ(run.channels[1].name, "strain");
}

}  // namespace
}  // namespace palpate::identify
