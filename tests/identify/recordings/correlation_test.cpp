#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "identify/recordings/describe.h"
#include "tests/identify/recordings/mat_sample.h"
#include "tests/identify/recordings/read_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

/// Position is rest and displacement.
void expect_point(const RecordedPoint& point, const Eigen::Vector3d& rest, const Eigen::Vector3d& moved) {
    EXPECT_TRUE(point.at.col(0).isApprox(rest + moved)) << point.at.col(0).transpose();
    EXPECT_TRUE(point.displacement.col(0).isApprox(moved));
}

TEST(Dice, IsInPixelsAndDropsWhatFailed) {
    FileMap map;
    map.unit = "pixel";
    map.pixel = 0.1;
    const Recording frame = read_sample(dice_sample, map);
    EXPECT_EQ(frame.format, "DICe, image correlation");
    ASSERT_EQ(frame.points.size(), 2u);
    EXPECT_EQ(frame.points[0].name, "0");
    expect_point(frame.points[0], {10, 20, 0}, {0.05, -0.025, 0});
    EXPECT_TRUE(frame.points[1].at.array().isNaN().all());
    EXPECT_TRUE(notes_tell(read_sample(dice_sample), "'unit: pixel'"));  // without a size, it is said
}

TEST(Dice, OfVersion1IsInPixelsToo) {
    const std::string columns = "COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,VSG_STRAIN_XX,GAMMA,MATCH\n";
    const std::string rows =
        "6.1E+01,9.71E+02,-1.5E-01,-2.5E+00,-1E-03,3.4E-03,0\n6.1E+01,9.36E+02,0,-2.5E+00,0,4E-03,0\n";
    for (const std::string& head :
         {std::string(), std::string("***\n*** Digital Image Correlation Engine (DICe)\n***\n")}) {
        const Recording frame = read_sample(head + columns + rows);
        EXPECT_EQ(frame.format, "DICe, image correlation");
        EXPECT_TRUE(notes_tell(frame, "'unit: pixel'"));
        EXPECT_THAT(describe(frame), testing::HasSubstr("x 0 pixel"));
        EXPECT_THAT(describe(frame), testing::HasSubstr("x, y, z [pixel]"));
        expect_point(frame.points[0], {61, 971, 0}, {-0.15, -2.5, 0});
    }
}

TEST(Aramis, HasNamesInAComment) {
    const Recording frame = read_sample(aramis_sample);
    EXPECT_EQ(frame.format, "GOM Aramis, image correlation");
    ASSERT_EQ(frame.points.size(), 2u);
    EXPECT_EQ(frame.points[0].name, "7");
    expect_point(frame.points[0], {1.5, 2, 3}, {0.1, 0.2, 0.3});
    EXPECT_TRUE(frame.points[1].at.array().isNaN().all());
}

/// A stage: where points stand in it, and how far that is from the first.
std::string gom_stage(double time, double moved) {
    return fmt::format(
        "# Units: length:mm angle:deg time:s \r\n# Stage: Stufe 2\r\nstage;index;relative_time;date\r\n\"Stufe "
        "2\";2;{};\"2023-02-10T13:54:18.404\"\r\n# Name : Facet\r\nid;x;y;z;displacement_x;displacement_y;"
        "displacement_z\r\n0;{};2;3;{};0;0\r\n1;{};5;6;{};0;0\r\n",
        time, 1 + moved, moved, 4 + moved, moved);
}

TEST(Gom, StagesTellWherePointsStandAndWhen) {
    const Recording frame = read_sample(gom_stage(21.5551, 0.25));
    EXPECT_EQ(frame.format, "GOM, image correlation");
    ASSERT_EQ(frame.points.size(), 2u);
    EXPECT_EQ(frame.points[0].name, "0");
    expect_point(frame.points[0], {1, 2, 3}, {0.25, 0, 0});
    ASSERT_TRUE(frame.has_clock);
    EXPECT_DOUBLE_EQ(frame.times[0], 21.5551);
    EXPECT_TRUE(notes_tell(frame, "of the stage"));
}

TEST(Gom, StagesInAFolderAreARecording) {
    const TemporaryFolder folder;
    folder.write("stages/Facet 1_0.000 s.csv", gom_stage(0, 0));
    folder.write("stages/Facet 1_21.555 s.csv", gom_stage(21.5551, 0.25));
    folder.write("stages/Facet 1_9.500 s.csv", gom_stage(9.5, 0.125));
    const Recording run = read_recordings(folder / "stages").at(0);
    EXPECT_TRUE(run.has_clock);
    EXPECT_TRUE(run.times.isApprox(Eigen::Vector3d(0, 9.5, 21.5551))) << run.times.transpose();
    EXPECT_DOUBLE_EQ(run.points.at(1).at(0, 2), 4.25);
}

TEST(Vic3d, TellsLargeLettersFromSmallOnes) {
    const Recording frame = read_sample(vic_sample);
    EXPECT_EQ(frame.format, "VIC-3D, image correlation");
    expect_point(frame.points[0], {1, 2, 3}, {0.1, 0.2, 0.3});
    EXPECT_TRUE(frame.points[1].at.array().isNaN().all());
}

TEST(MuDic, HasAColumnForEachComponent) {
    const Recording frame = read_sample("x,y,u_x,u_y,e_xx\n1,2,0.5,0.25,0\n3,4,0.5,0.25,0\n");
    EXPECT_EQ(frame.format, "image correlation, a row for each point");
    expect_point(frame.points[1], {3, 4, 0}, {0.5, 0.25, 0});
}

TEST(LongTables, HaveARowForEachPointAndFrame) {
    const Recording run = read_sample(long_sample);
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[0].name, "a");
    ASSERT_EQ(run.times.size(), 2);
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(1.5, 2, 3));
    EXPECT_EQ(run.points[1].at.col(1), Eigen::Vector3d(4.5, 5, 6));
    EXPECT_FALSE(run.has_clock);
    const auto twice = [] { read_sample("frame,marker,x,y,z\n0,a,1,2,3\n0,a,4,5,6\n"); };
    EXPECT_TRUE(says(message_of(twice), {"line 3", "'a' comes twice"}));
    const auto unknown = [] { read_sample("frame,marker,x,y,z\n0,a,1,2,3\n,a,4,5,6\n"); };
    EXPECT_TRUE(says(message_of(unknown), {"line 3", "frame", "empty"}));
}

TEST(LongTables, TimesMakeTheClock) {
    const Recording run = read_sample("time,id,x,y,z\n0.5,1,1,2,3\n0.5,2,1,2,3\n0.75,1,4,5,6\n");
    EXPECT_EQ(run.times, Eigen::Vector2d(0.5, 0.75));
    EXPECT_TRUE(run.has_clock);
    EXPECT_TRUE(run.points[1].at.col(1).array().isNaN().all());
}

TEST(LongTables, MapNamesTheirColumns) {
    FileMap map;
    map.point_column = ColumnPlace{"who", ""};
    map.frame_column = ColumnPlace{"when", ""};
    map.points = {{"any", {{"p", ""}, {"q", ""}}, {}}};
    const Recording run = read_sample("when,who,p,q\n1,7,0,1\n2,7,0,2\n", map);
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(0, 2, 0));
    map.points.clear();
    EXPECT_TRUE(
        says(message_of([&] { read_sample("when,who,p,q\n1,7,0,1\n2,7,0,2\n", map); }), {"no columns of coordinates"}));
}

TEST(Ncorr, HoldsAGridOfDisplacements) {
    const TemporaryFolder folder;
    const Recording run = read_recordings(write_ncorr(folder / "dic.mat"))[0];
    EXPECT_EQ(run.format, "Ncorr, image correlation");
    ASSERT_EQ(run.points.size(), 5u);  // of six: one lies outside
    ASSERT_EQ(run.times.size(), 2);
    // Column 3, row 2 of the grid: 5 pixels of 0.1 mm apart.
    EXPECT_EQ(run.points[4].name, "3 2");
    expect_point(run.points[4], {1, 0.5, 0}, {0.5, 0.25, 0});
    EXPECT_DOUBLE_EQ(run.points[4].displacement(0, 1), 1);
}

TEST(MultiDic, HoldsPointsInSpace) {
    const TemporaryFolder folder;
    const Recording run = read_recordings(write_multidic(folder / "dic.mat"))[0];
    EXPECT_EQ(run.format, "MultiDIC, image correlation");
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[1].at.col(0), Eigen::Vector3d(4, 5, 6));
    EXPECT_EQ(run.points[0].displacement.col(1), Eigen::Vector3d(0.5, 0, 0));
    EXPECT_TRUE(run.points[1].at.col(1).array().isNaN().all());
}

TEST(Matlab, SaysWhatItHolds) {
    const TemporaryFolder folder;
    EXPECT_TRUE(says(message_of([&] { read_recordings(write_other_mat(folder / "a.mat")); }),
                     {"a.mat", "'answer'", "data_dic_save", "Points3D"}));
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder.write("b.mat", "MATLAB 5.0 MAT-file, cut")); }),
                     {"b.mat", "MATLAB"}));
}

TEST(Scans, AreFramesOfOne) {
    const TemporaryFolder folder;
    const Recording ply = read_recordings(folder.write("scan.ply", ply_sample))[0];
    ASSERT_EQ(ply.points.size(), 3u);
    EXPECT_EQ(ply.points[1].at.col(0), Eigen::Vector3d(1, 0, 0));
    const Recording vtk = read_recordings(folder.write("scan.vtk", vtk_sample))[0];
    ASSERT_EQ(vtk.points.size(), 2u);
    EXPECT_EQ(vtk.points[1].name, "15");
    expect_point(vtk.points[1], {1, 0, 0}, {0, 0, 2});
}

TEST(Series, FilesAreFramesInTheOrderOfTheirNumbers) {
    const TemporaryFolder folder;
    for (const int n : {1, 2, 10})
        folder.write("scan_" + std::to_string(n) + ".ply",
                     replaced(ply_sample, "0 1 0\n", "0 1 " + std::to_string(n) + "\n"));
    const auto expect_series = [&](const std::vector<Recording>& read) {
        ASSERT_EQ(read.size(), 1u);
        ASSERT_EQ(read[0].times.size(), 3);
        EXPECT_EQ(read[0].points[2].at.row(2), Eigen::RowVector3d(1, 2, 10));
    };
    expect_series(read_recordings(folder.path()));
    // A licence and notes beside the data are none of it.
    for (const char* name : {"LICENSE.txt", "README", "notes.md"}) folder.write(name, "no data\n");
    expect_series(read_recordings(folder.path()));
    expect_series(read_recordings(folder / "scan_*.ply"));
    FileMap map;
    map.series = true;
    map.rate = 10;
    expect_series(read_recordings(folder / "scan_2.ply", map));
    EXPECT_DOUBLE_EQ(read_recordings(folder / "scan_2.ply", map)[0].times[2], 0.2);

    folder.write("scan_11.ply", replaced(replaced(ply_sample, "vertex 3", "vertex 2"), "0 1 0\n", ""));
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder.path()); }), {"scan_11.ply has 2 points", "has 3"}));
    folder.write("scan_11.ply", "t,F\n0,1\n1,2\n");
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder.path()); }), {"scan_11.ply", "no points"}));
    EXPECT_TRUE(says(message_of<IoError>([&] { read_recordings(folder / "other_*.ply"); }), {"other_*.ply"}));
}

TEST(Series, CorrelatedPointsAreMatchedByTheirPlaceAtRest) {
    const TemporaryFolder folder;
    folder.write("B1.csv", "X,Y,Z,U,V,W,sigma\n1,2,3,0,0,0,0.1\n4,5,6,0,0,0,0.1\n");
    folder.write("B2.csv", "X,Y,Z,U,V,W,sigma\n4,5,6,0,0,1,0.1\n");  // the first was lost
    const Recording run = read_recordings(folder / "B*.csv")[0];
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_TRUE(run.points[0].at.col(1).array().isNaN().all());
    EXPECT_EQ(run.points[1].at.col(1), Eigen::Vector3d(4, 5, 7));
}

TEST(Series, PlacesThatRoundToNeighbouringCellsAreOne) {
    const TemporaryFolder folder;
    // -1.68305 lies on the border of two cells of the grid, as does what it is read back as.
    folder.write("B1.csv", "X,Y,Z,U,V,W,sigma\n-1.68305,2,3,0,0,0,0.1\n4,5,6,0,0,0,0.1\n");
    folder.write("B2.csv", "X,Y,Z,U,V,W,sigma\n-1.68305,2,3,0.30001,0,0,0.1\n4,5,6,0,0,0,0.1\n");
    EXPECT_EQ(read_recordings(folder / "B*.csv")[0].points.size(), 2u);
}

TEST(Series, IsOfTheNumberInWhichFilesDiffer) {
    const TemporaryFolder folder;
    FileMap map;
    map.series = true;
    for (const char* name : {"def_0_vic3d.ply", "def_1_vic3d.ply"}) folder.write(name, ply_sample);
    EXPECT_EQ(read_recordings(folder / "def_0_vic3d.ply", map)[0].times.size(), 2);
    folder.write("alone_7.ply", ply_sample);
    EXPECT_TRUE(
        says(message_of([&] { read_recordings(folder / "alone_7.ply", map); }), {"alone_7.ply", "'series: true'"}));
}

TEST(Correlation, OneSubsetIsARowAFrame) {
    const Recording run = read_sample(
        "*** Digital Image Correlation Engine (DICe)\nFRAME,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,"
        "SIGMA,GAMMA,BETA\n4837,266,376,0,0,0.01,0,0\n4838,266,376,0.5,0.25,0.01,0,0\n");
    EXPECT_EQ(run.format, "DICe, image correlation");
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(266.5, 376.25, 0));
}

TEST(Correlation, NodesOfASimulationHaveTheirColumnsNames) {
    const Recording run = read_sample(
        "#   index   ;    x_undf  ;    y_undf  ;    z_undf  ;    ux      ;    uy      ;    uz      ;    eps_x   ;   "
        "eps_y\n"
        "         1;   -100.0;      2.0;      3.0;      0.5;       0.0;      0.25;      0.1;   0.2\n"
        "         2;   -99.0;      2.0;      3.0;      0.5;       0.0;      0.25;      0.1;   0.2\n"
        "         3;   -98.0;      2.0;      3.0;      0.5;       0.0;      0.25;      0.1;   0.2\n");
    ASSERT_EQ(run.points.size(), 3u);
    EXPECT_EQ(run.points[2].name, "3");
    EXPECT_EQ(run.points[2].at.col(0), Eigen::Vector3d(-97.5, 2, 3.25));
}

TEST(Correlation, AMatrixOverTheImageIsNoMotionCapture) {
    const TemporaryFolder folder;
    const auto file = folder.write("plate_1.tif_U[mm].csv", "-0,1;0,2;Non un numero reale\n0,1;0,2;0,3\n0,1;0,2;0,3\n");
    EXPECT_TRUE(says(message_of([&] { read_recordings(file); }), {"MatchID", "3 rows and 3 columns", "x, y, u, v"}));
}

TEST(Series, CollectionTellsItsFilesAndTimes) {
    const TemporaryFolder folder;
    folder.write("a.vtk", vtk_sample);
    folder.write("b.vtk", replaced(vtk_sample, "0 0 1 0 0 2", "0 0 1 0 0 3"));
    const std::string head = "<VTKFile type=\"Collection\" version=\"1.0\"><Collection>\n";
    const Recording run = read_recordings(folder.write(
        "all.pvd",
        head + "<DataSet timestep=\"0.5\" file=\"a.vtk\"/>\n<DataSet timestep=\"0.75\" file=\"b.vtk\"/>\n"))[0];
    EXPECT_EQ(run.times, Eigen::Vector2d(0.5, 0.75));
    EXPECT_EQ(run.points[1].displacement(2, 1), 3);
    const auto refusal = [&](const std::string& entries) {
        return message_of([&] { read_recordings(folder.write("all.pvd", head + entries)); });
    };
    EXPECT_TRUE(says(refusal(""), {"names no file"}));
    EXPECT_TRUE(says(refusal("<DataSet timestep=\"0\" file=\"all.pvd\"/>"), {"is a series itself"}));
    EXPECT_TRUE(says(refusal("<DataSet timestep=\"0\" file=\"../a.vtk\"/>"), {"../a.vtk", "in the folder"}));
}

}  // namespace
}  // namespace palpate::identify
