#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/identify/recordings/read_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

/// The same table however it is written: time 0, 0.5; force 1234.5, -2.
void expect_the_table(const std::string& text, const std::string& how) {
    const Recording run = read_sample(text);
    ASSERT_EQ(run.channels.size(), 1u) << text;
    EXPECT_EQ(run.channels[0].name, "Force");
    EXPECT_EQ(run.channels[0].unit, "N");
    ASSERT_EQ(run.times.size(), 2);
    EXPECT_EQ(run.times[1], 0.5);
    EXPECT_EQ(run.channels[0].values, Eigen::Vector2d(1234.5, -2)) << text;
    EXPECT_TRUE(notes_tell(run, how)) << how;
}

TEST(Tables, AreReadHoweverTheyAreWritten) {
    expect_the_table("Time [s],Force [N]\n0,1234.5\n0.5,-2\n", "a comma");
    expect_the_table("Time (s);Force (N)\r\n0;1234.5\r\n0.5;-2\r\n", "a semicolon");
    expect_the_table("Time [s]\tForce [N]\n0,0\t1234,5\n0,5\t-2\n", "decimal comma");
    expect_the_table("Time [s];Force [N]\n0,0;1.234,5\n0,5;-2,0\n", "thousands separated by '.'");
    expect_the_table("\"Time [s]\",\"Force [N]\"\n\"0.0\",\"1,234.5\"\n\"0.5\",\"-2.0\"\n",
                     "thousands separated by ','");
    expect_the_table("time_s Force_N\n 0.0   1234.5 \n 0.5  -2e0\n", "blanks");
    expect_the_table("\xEF\xBB\xBFTime,Force\ns,N\n0,1234.5\n0.5,-2\n", "UTF-8 with a byte order mark");
    expect_the_table("a preamble\n\nTime,Force\n(sec),(N)\n0,1234.5\n0.5,-2\n\n", "line 4 tells units");
    expect_the_table("# Time [s], Force [N]\n0,1234.5\n# a remark\n0.5,-2\n", "line 1 names the columns");
    std::string wide = "\xFF\xFE";
    for (const char c : std::string("Time [s];Force [N]\n0;1234,5\n0,5;-2\n")) wide += {c, '\0'};
    expect_the_table(wide, "UTF-16");
}

TEST(Tables, MissingCellsAreNoNumbers) {
    const Recording run = read_sample("time,F,u\n0,1,nan\n1,,2\n2,NA,--\n3,4,5\n");
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[0].values.array().isNaN().count(), 2);
    EXPECT_EQ(run.channels[1].values.array().isNaN().count(), 2);
    EXPECT_EQ(run.channels[1].values[3], 5);
}

TEST(Tables, OneColumnOfDecimalCommasIsOne) {
    const Recording run = read_sample("0,038\n0,125\n1,5\n");
    ASSERT_EQ(run.channels.size(), 1u);
    EXPECT_EQ(run.channels[0].values, Eigen::Vector3d(0.038, 0.125, 1.5));
}

TEST(Tables, DatesInColumnsOfNumbersAreRefusedByCell) {
    EXPECT_TRUE(says(refusal_of("time;F\n0;1,5\n1;2,5\n2;03.05.2024\n3;4,5\n"),
                     {"run.csv", "line 4", "'F'", "'03.05.2024'", "a date", "spreadsheet"}));
    EXPECT_TRUE(says(refusal_of("time,F\n0,1.5\n1,2.5\n2,12-May\n3,4.5\n"), {"line 4", "12-May", "a date"}));
    EXPECT_TRUE(says(refusal_of("F\n1.5\n2.5\n3/4/2024\n4.5\n"), {"line 4", "3/4/2024", "a date"}));
    EXPECT_TRUE(says(refusal_of("time,F\n0,1.5\n1,broken\n2,3\n"), {"line 3", "'F'", "'broken'", "no number"}));
    EXPECT_TRUE(says(refusal_of("F\n1.5\nbroken\n4.5\n"), {"line 3", "broken", "goes on below"}));
}

TEST(Tables, TimesMayBeTimesOfDay) {
    const Recording run = read_sample("clock,F\n23:59:59.5,1\n00:00:00.25,2\n");
    FileMap map;
    map.time = ColumnPlace{"clock", ""};
    const Recording told = read_sample("clock,F\n23:59:59.5,1\n00:00:00.25,2\n", map);
    EXPECT_NEAR(told.times[1] - told.times[0], 0.75, 1e-9);
    EXPECT_FALSE(run.has_clock);
    const Recording dated = read_sample("timestamp,F\n2024-05-01T23:59:59.5,1\n2024-05-02T00:00:01,2\n");
    EXPECT_NEAR(dated.times[1] - dated.times[0], 1.5, 1e-6);
    EXPECT_TRUE(says(refusal_of("time,F\n12:00:01,1\n12:61:01,2\n"), {"line 3", "12:61:01", "is no time"}));
}

TEST(Tables, TimesRiseAndHaveAUnit) {
    EXPECT_NEAR(read_sample("time (ms),F\n0,1\n250,2\n").times[1], 0.25, 1e-12);
    EXPECT_NEAR(read_sample("timestamp,F\n1700000000000,1\n1700000000250,2\n").times[1] - 1.7e9, 0.25, 1e-6);
    EXPECT_TRUE(says(refusal_of("time,F\n0,1\n2,2\n1,3\n"), {"line 4", "from 2 to 1", "'rate'"}));
    EXPECT_TRUE(says(refusal_of("time,F\n0,1\n,2\n1,3\n"), {"line 3", "the time is missing"}));
    EXPECT_TRUE(notes_tell(read_sample("time,F\n0,1\n1,2\n1,3\n"), "1 times are those of the row before"));
}

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
    EXPECT_NEAR(run.times[1] - run.times[0], 0.25, 1e-6);  // a double holds 1.7e9 s to 2e-7
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].name, "field.pose.position");
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(Tables, WithoutNamesAClockAndThreesAreGuessedAndSaid) {
    const Recording run = read_sample("0,0.000,1,2,3,4,5,6\n1,0.005,1,2,3,4,5,6\n2,0.010,1,2,3,4,5,7\n");
    EXPECT_NEAR(run.times[2], 0.01, 1e-12);
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[1].at(2, 2), 7);
    EXPECT_TRUE(notes_tell(run, "2 points"));
    EXPECT_TRUE(notes_tell(run, "no unit of positions is given"));
}

TEST(Tables, BluehillHasPreambleQuotesAndARowOfUnits) {
    const Recording run = read_sample(bluehill_sample);
    EXPECT_EQ(run.format, "testing machine, Instron Bluehill");
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[1].name, "Load");
    EXPECT_EQ(run.channels[1].unit, "N");
    EXPECT_NEAR(run.channels[1].values[2], 2.1, 1e-12);
    EXPECT_NEAR(run.times[1], 0.1, 1e-12);
}

TEST(Tables, BluehillInQuotesHasDecimalCommasBetweenCommas) {
    const std::string text =
        "Specimen properties : Final anvil height,\"2,22\",mm\nSpecimen properties : Specimen label,\"\"\n\n"
        "Time,Extension,Load,Compressive strain (Extension),Cycle count\n(s),(mm),(kN),(mm/mm),\n"
        "\"0,0\",\"0,0\",\"0,0\",\"0,0\",\"0\"\n\"0,1\",\"-0,02\",\"-0,02\",\"-0,01\",\"1\"\n";
    for (const std::optional<char> decimal : {std::optional<char>(), std::optional(',')}) {
        FileMap map;
        map.decimal = decimal;
        const Recording run = read_sample(text, map);
        ASSERT_EQ(run.times.size(), 2);
        EXPECT_NEAR(run.times[1], 0.1, 1e-12);
        ASSERT_GE(run.channels.size(), 2u);
        EXPECT_EQ(run.channels[1].name, "Load");
        EXPECT_NEAR(run.channels[1].values[1], -20, 1e-9);
    }
}

TEST(Tables, RemarksBesideTheTableAreNoNames) {
    const Recording run = read_sample(
        "Time,Extension,Load,,10 mm/min\n(s),(mm),(N),,20 N preload\n0,0.5,20,,\n0.1,0.6,21.5,,\n0.2,0.7,22,,\n");
    EXPECT_EQ(run.format, "testing machine, Instron Bluehill");
    ASSERT_TRUE(run.has_clock);
    EXPECT_NEAR(run.times[2], 0.2, 1e-12);
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[1].name, "Load");
    EXPECT_EQ(run.channels[1].unit, "N");
}

TEST(Tables, GroupsOfThousandsInQuotesAreNoDecimals) {
    const Recording run = read_sample("time,force\n0,\"1,234\"\n1,\"2,345\"\n");
    EXPECT_NEAR(run.channels.at(0).values[1], 2345, 1e-9);
}

TEST(Tables, PosesAreNamedByPositionAndQuaternion) {
    const Recording run =
        read_sample("time\ttip-px\ttip-py\ttip-pz\ttip-qx\ttip-qy\ttip-qz\n0\t1\t2\t3\t0\t0\t1\n1\t4\t5\t6\t0\t0\t1\n");
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].name, "tip");
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(Tables, ZwickHasLatinLettersAndDecimalCommas) {
    const Recording run = read_sample(zwick_sample);
    EXPECT_EQ(run.format, "testing machine, Zwick testXpert");
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[1].name, "Standardkraft");
    EXPECT_NEAR(run.channels[1].values[1], 1235.25, 1e-12);
    EXPECT_NEAR(run.times[2], 0.2, 1e-12);
    EXPECT_TRUE(notes_tell(run, "Latin-1"));
}

TEST(Tables, MapNamesColumnsAlsoOfFilesBeside) {
    const TemporaryFolder folder;
    folder.write("force.dat", "0.5\n0.6\n");
    FileMap map;
    map.rate = 4;
    map.channels = {{{"1", ""}, "u", "cm"}, {{"1", "force.dat"}, "F", "kN"}};
    const auto run = read_recordings(folder.write("u.dat", "1\n2\n"), map)[0];
    EXPECT_EQ(run.channels[0].values[1], 20);
    EXPECT_EQ(run.channels[1].values[0], 500);
    EXPECT_EQ(run.times[1], 0.25);

    folder.write("force.dat", "0.5\n0.6\n0.7\n");
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder / "u.dat", map); }), {"force.dat has 3 rows", "has 2"}));
    map.channels[1].place.file = "../force.dat";
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder / "u.dat", map); }), {"../force.dat", "in the folder"}));
}

TEST(Tables, MapNamesColumnsThatAreThere) {
    FileMap map;
    map.channels = {{{"Forc", ""}, "", ""}};
    EXPECT_TRUE(says(refusal_of("time,Force\n0,1\n1,2\n", map), {"'Forc'", "did you mean 'Force'", "'time'"}));
    map.channels = {{{"7", ""}, "", ""}};
    EXPECT_TRUE(says(refusal_of("time,Force\n0,1\n1,2\n", map), {"no column 7", "1 to 2"}));
    map.channels = {{{"F", ""}, "", ""}};
    EXPECT_TRUE(says(refusal_of("F,F\n0,1\n1,2\n", map), {"2 columns are named 'F'", "number"}));
    map.channels = {{{"day", ""}, "", ""}};
    EXPECT_TRUE(says(refusal_of("t,day\n0,01.02.2024\n1,02.02.2024\n", map), {"'day'", "01.02.2024", "spreadsheet"}));
}

TEST(Tables, MapTellsWhereTheNumbersBegin) {
    FileMap map;
    map.header_lines = 5;
    const Recording run = read_sample("t,F\n0,1\n1,2\n2,3\nt,G\n0,5\n1,6\n", map);
    ASSERT_EQ(run.channels.size(), 1u);
    EXPECT_EQ(run.channels[0].name, "G");
    map.names_line = 6;
    EXPECT_TRUE(says(refusal_of("t,F\n0,1\n1,2\n2,3\nt,G\n0,5\n1,6\n", map), {"line 6", "begin in line 6"}));
    map.header_lines = 50;
    EXPECT_TRUE(says(refusal_of("t,F\n0,1\n", map), {"no row of numbers", "line 50"}));
}

TEST(Sheets, AreMatricesOfCoordinates) {
    const TemporaryFolder folder;
    folder.write("x0.dat", " 1.0\n 2.0\n");
    folder.write("y0.dat", " 3.0\n 4.0\n");
    folder.write("xt.dat", " 1.1\t 1.2\t 1.3\t\n 2.1\t 2.2\t nan\t\n");
    folder.write("yt.dat", " 3.1\t 3.2\t 3.3\t\n 4.1\t 4.2\t 4.3\t\n");
    FileMap map;
    map.unit = "pixel";
    map.pixel = 0.5;
    map.sheets = MappedSheets{{"xt.dat", "yt.dat"}, {"x0.dat", "y0.dat"}, false};
    const auto run = read_recordings(folder / "xt.dat", map)[0];
    ASSERT_EQ(run.points.size(), 2u);
    ASSERT_EQ(run.times.size(), 4);
    EXPECT_TRUE(run.points[0].at.col(0).isApprox(Eigen::Vector3d(0.5, 1.5, 0)));
    EXPECT_TRUE(run.points[1].at.col(2).isApprox(Eigen::Vector3d(1.1, 2.1, 0)));
    EXPECT_TRUE(run.points[1].at.col(3).array().isNaN().all());
    EXPECT_FALSE(run.has_clock);

    map.sheets->frames_in_rows = true;
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder / "xt.dat", map); }), {"3 points", "frames_in"}));
    folder.write("yt.dat", " 3.1 3.2\n 4.1 4.2\n");
    map.sheets->frames_in_rows = false;
    EXPECT_TRUE(
        says(message_of([&] { read_recordings(folder / "xt.dat", map); }), {"yt.dat holds 2 points and 2 frames"}));
    map.sheets->at = {"xt.dat", "zt.dat"};
    EXPECT_TRUE(says(message_of<IoError>([&] { read_recordings(folder / "xt.dat", map); }), {"zt.dat"}));
}

TEST(Unknown, SaysWhatWasRecognisedAndGivesAMap) {
    EXPECT_TRUE(says(refusal_of("Dear colleague,\nno numbers here.\n"),
                     {"no row of numbers", "Recognised: text (UTF-8", "Not recognised", "TRC", "Motive", "Vicon",
                      "files:\n  - file: \"run.csv\"", "header_lines"}));
    EXPECT_TRUE(says(refusal_of(std::string("PK\x03\x04\0\0\0", 7)), {"run.csv", "spreadsheet", "CSV"}));
    EXPECT_TRUE(says(refusal_of(std::string("\1\0\2\0\3", 5)), {"it is binary", "C3D", "MATLAB"}));
    EXPECT_TRUE(says(refusal_of("solid a\nfacet normal 0 0 1\n"), {"STL", "body"}));
    EXPECT_TRUE(says(refusal_of(""), {"run.csv", "empty"}));
    EXPECT_TRUE(says(refusal_of("frame,note\n1,a\n2,b\n"), {"neither points nor channels", "A map to start from"}));
    EXPECT_TRUE(says(message_of<IoError>([] { read_recordings("/nowhere/run.csv"); }), {"/nowhere/run.csv"}));
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

TEST(Machines, OfZwickSpeakFrench) {
    const Recording pull = read_sample(
        "\"Temps\",\"Traverse absolue\",\"Force standard\",\"Course standard\"\n\"s\",\"mm\",\"N\",\"mm\"\n"
        "0.1,-794,1,0\n0.2,-794,2,0.1\n0.3,-794,n. def.,0.2\n");
    EXPECT_EQ(pull.format, "testing machine, Zwick testXpert");
    ASSERT_EQ(pull.channels.size(), 3u);
    EXPECT_TRUE(std::isnan(pull.channels[1].values[2]));
}

}  // namespace
}  // namespace palpate::identify
