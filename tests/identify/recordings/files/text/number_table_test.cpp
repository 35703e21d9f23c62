#include <gtest/gtest.h>

#include "tests/identify/recordings/read_sample.h"

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

TEST(Tables, GroupsOfThousandsInQuotesAreNoDecimals) {
    const Recording run = read_sample("time,force\n0,\"1,234\"\n1,\"2,345\"\n");
    EXPECT_DOUBLE_EQ(run.channels.at(0).values[1], 2345);
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
    EXPECT_DOUBLE_EQ(told.times[1] - told.times[0], 0.75);
    EXPECT_FALSE(run.has_clock);
    const Recording dated = read_sample("timestamp,F\n2024-05-01T23:59:59.5,1\n2024-05-02T00:00:01,2\n");
    EXPECT_NEAR(dated.times[1] - dated.times[0], 1.5, 2.4e-7);  // doubles of 1.7e9 s are 2^-22 s apart
    EXPECT_TRUE(says(refusal_of("time,F\n12:00:01,1\n12:61:01,2\n"), {"line 3", "12:61:01", "is no time"}));
}

TEST(Tables, TimesRiseAndHaveAUnit) {
    EXPECT_DOUBLE_EQ(read_sample("time (ms),F\n0,1\n250,2\n").times[1], 0.25);
    EXPECT_NEAR(read_sample("timestamp,F\n1700000000000,1\n1700000000250,2\n").times[1] - 1.7e9, 0.25, 2.4e-7);
    EXPECT_TRUE(says(refusal_of("time,F\n0,1\n2,2\n1,3\n"), {"line 4", "from 2 to 1", "'rate'"}));
    EXPECT_TRUE(says(refusal_of("time,F\n0,1\n,2\n1,3\n"), {"line 3", "the time is missing"}));
    EXPECT_TRUE(notes_tell(read_sample("time,F\n0,1\n1,2\n1,3\n"), "1 times are those of the row before"));
}

}  // namespace
}  // namespace palpate::identify
