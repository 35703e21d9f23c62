#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/identify/recordings/read_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

TEST(Tables, BluehillHasPreambleQuotesAndARowOfUnits) {
    const Recording run = read_sample(bluehill_sample);
    EXPECT_EQ(run.format, "testing machine, Instron Bluehill");
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[1].name, "Load");
    EXPECT_EQ(run.channels[1].unit, "N");
    EXPECT_DOUBLE_EQ(run.channels[1].values[2], 2.1);
    EXPECT_DOUBLE_EQ(run.times[1], 0.1);
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
        EXPECT_DOUBLE_EQ(run.times[1], 0.1);
        ASSERT_GE(run.channels.size(), 2u);
        EXPECT_EQ(run.channels[1].name, "Load");
        EXPECT_DOUBLE_EQ(run.channels[1].values[1], -20);
    }
}

TEST(Tables, RemarksBesideTheTableAreNoNames) {
    const Recording run = read_sample(
        "Time,Extension,Load,,10 mm/min\n(s),(mm),(N),,20 N preload\n0,0.5,20,,\n0.1,0.6,21.5,,\n0.2,0.7,22,,\n");
    EXPECT_EQ(run.format, "testing machine, Instron Bluehill");
    ASSERT_TRUE(run.has_clock);
    EXPECT_DOUBLE_EQ(run.times[2], 0.2);
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[1].name, "Load");
    EXPECT_EQ(run.channels[1].unit, "N");
}

TEST(Tables, ZwickHasLatinLettersAndDecimalCommas) {
    const Recording run = read_sample(zwick_sample);
    EXPECT_EQ(run.format, "testing machine, Zwick testXpert");
    ASSERT_EQ(run.channels.size(), 2u);
    EXPECT_EQ(run.channels[1].name, "Standardkraft");
    EXPECT_DOUBLE_EQ(run.channels[1].values[1], 1235.25);
    EXPECT_DOUBLE_EQ(run.times[2], 0.2);
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
