#include <gtest/gtest.h>

#include "identify/recordings/describe.h"
#include "identify/recordings/files/draft_map.h"
#include "identify/recordings/files/read_recordings.h"
#include "tests/identify/recordings/c3d_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

FileMap map_of(const std::string& text) {
    const auto fields = mesh::YamlFields::from_text(text, "map.yaml");
    FileMap map = read_file_map(fields);
    fields.finish();
    return map;
}

std::string map_refusal(const std::string& text) {
    return message_of([&] { map_of(text); });
}

/// The one entry of a drafted map.
FileMap drafted(const std::string& text) {
    const auto fields = mesh::YamlFields::from_text(text, "map.yaml");
    const auto entries = fields.mappings("files");
    fields.finish();
    EXPECT_EQ(entries.size(), 1u);
    EXPECT_FALSE(entries[0].text("file").empty());
    FileMap map = read_file_map(entries[0]);
    entries[0].finish();
    return map;
}

TEST(FileMaps, SayAllThatAFileCannot) {
    const FileMap map = map_of(
        "format: table\nencoding: latin-1\ndelimiter: semicolon\ndecimal: comma\nheader_lines: 5\nnames_line: 4\n"
        "time: t\ntime_unit: ms\nrate: 200\nunit: pixel\npixel: 0.05\nnames: [a, b]\nseries: true\n"
        "points: [{name: tip, at: [\"3\", \"4\"], displacement: [\"5\", \"6\"], file: b.dat}]\n"
        "channels: [{column: F, name: force, unit: kN, file: f.dat}]\npoint_column: id\nframe_column: stage\n"
        "sheets: {at: [x, y], rest: [u, v], frames_in: rows}\n");
    EXPECT_EQ(map.format, "table");
    EXPECT_EQ(map.encoding, "latin-1");
    EXPECT_EQ(map.delimiter, ';');
    EXPECT_EQ(map.decimal, ',');
    EXPECT_EQ(map.header_lines, 5);
    EXPECT_EQ(map.names_line, 4);
    EXPECT_EQ(map.time->column, "t");
    EXPECT_EQ(map.time_unit, "ms");
    EXPECT_EQ(map.rate, 200);
    EXPECT_EQ(map.pixel, 0.05);
    EXPECT_EQ(map.names.size(), 2u);
    EXPECT_EQ(map.points.at(0).at.at(1).column, "4");
    EXPECT_EQ(map.points.at(0).displacement.at(1).file, "b.dat");
    EXPECT_EQ(map.channels.at(0).unit, "kN");
    EXPECT_TRUE(map.point_column && map.frame_column && map.series);
    EXPECT_TRUE(map.sheets->frames_in_rows);
}

TEST(FileMaps, SayWhatIsWrong) {
    EXPECT_TRUE(says(map_refusal("format: excel\n"), {"map.yaml, line 1", "'excel'", "'c3d'"}));
    EXPECT_TRUE(says(map_refusal("unit: pixel\n"), {"size of a pixel"}));
    EXPECT_TRUE(says(map_refusal("rate: 0\n"), {"rate", "outside"}));
    EXPECT_TRUE(says(map_refusal("points: [{name: a, at: [\"1\"]}]\n"), {"1 columns", "[x, y, z]"}));
    EXPECT_TRUE(says(map_refusal("sheets: {at: [x]}\n"), {"1 files", "x and y"}));
    EXPECT_TRUE(says(map_refusal("sheets: {at: [x, y], rest: [u]}\n"), {"1 files", "2 in 'at'"}));
    EXPECT_TRUE(says(map_refusal("format: sheets\n"), {"which files"}));
    EXPECT_TRUE(says(map_refusal("colour: red\n"), {"colour"}));
}

/// A drafted map is read back, and reads the file as it was read without it.
TEST(DraftedMaps, ReadTheFileAsBefore) {
    const TemporaryFolder folder;
    const std::vector<std::pair<std::string, std::string>> files{
        {"run.c3d", C3dSample().bytes()}, {"run.trc", trc_sample},
        {"take.csv", motive_sample},      {"trial.csv", vicon_sample},
        {"pull.csv", bluehill_sample},    {"zug.TRA", zwick_sample},
        {"dice.txt", dice_sample},        {"aramis.txt", aramis_sample},
        {"long.csv", long_sample},        {"t.csv", "0,0.000,1,2,3,4,5,6\n1,0.005,1,2,3,4,5,6\n2,0.010,1,2,3,4,5,7\n"}};
    for (const auto& [name, content] : files) {
        const auto file = folder.write(name, content);
        const auto before = read_recordings(file);
        const std::string draft = draft_map(file, before);
        const auto after = read_recordings(file, drafted(draft));
        ASSERT_EQ(after.size(), before.size()) << draft;
        EXPECT_EQ(after[0].points.size(), before[0].points.size()) << draft;
        EXPECT_EQ(after[0].channels.size(), before[0].channels.size()) << draft;
        EXPECT_TRUE(after[0].times.isApprox(before[0].times)) << draft;
        for (std::size_t p = 0; p < before[0].points.size(); ++p) {
            EXPECT_EQ(after[0].points[p].name, before[0].points[p].name);
            EXPECT_TRUE(after[0].points[p].at.col(0).isApprox(before[0].points[p].at.col(0)) ||
                        before[0].points[p].at.col(0).array().isNaN().any());
        }
    }
}

TEST(DraftedMaps, BeginWithWhatIsKnownOfAnyText) {
    const TemporaryFolder folder;
    const std::string draft = draft_map(folder.write("letter \"a\".txt", "Dear colleague;\n"), {});
    EXPECT_NO_THROW(drafted(draft)) << draft;
}

TEST(Descriptions, TellPointsFramesClockAndChannels) {
    const TemporaryFolder folder;
    const auto recordings = read_recordings(folder.write("run.c3d", C3dSample().bytes()));
    const std::string points = describe(recordings[0]), analogs = describe(recordings[1]);
    for (const char* word :
         {"run.c3d: C3D, points", "3, from 0 to 0.02 s, 100 a second", "points    2", "16.7 % missing", "Tip", "33.3 %",
          "10000, 2000, 3000", "events    1", "Touch", "in m, here in mm"})
        EXPECT_NE(points.find(word), std::string::npos) << word << " is not in\n" << points;
    for (const char* word : {"analogs", "channels  2", "Fz", "N ", "200 a second"})
        EXPECT_NE(analogs.find(word), std::string::npos) << word << " is not in\n" << analogs;
}

TEST(Descriptions, TellThatAClockIsMissingOrUneven) {
    const TemporaryFolder folder;
    EXPECT_NE(describe(read_recordings(folder.write("a.csv", "F\n1\n2\n"))[0]).find("no clock"), std::string::npos);
    // 60 a second, written with three digits
    EXPECT_NE(describe(read_recordings(folder.write("a.csv", "t,F\n0,1\n0.017,2\n0.033,2\n0.050,2\n"))[0])
                  .find("60 a second"),
              std::string::npos);
    EXPECT_NE(describe(read_recordings(folder.write("a.csv", "t,F\n0,1\n1,2\n5,2\n"))[0]).find("not steady"),
              std::string::npos);
}

}  // namespace
}  // namespace palpate::identify
