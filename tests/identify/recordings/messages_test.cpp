// Each message about a file that is none, and is not seen in another test.

#include "mesh/errors.h"
#include "tests/identify/recordings/c3d_sample.h"
#include "tests/identify/recordings/mat_sample.h"
#include "tests/identify/recordings/read_sample.h"
#include "tests/identify/recordings/text_samples.h"

namespace palpate::identify {
namespace {

FileMap as(const char* format) {
    FileMap map;
    map.format = format;
    return map;
}

/// The bytes of a C3D file with others so far behind a parameter's name.
std::string patched(std::string bytes, const std::string& name, std::size_t behind, const std::string& other) {
    return bytes.replace(bytes.find(name) + name.size() + behind, other.size(), other);
}

TEST(Messages, OfC3d) {
    const C3dSample sample;
    const std::string sound = sample.bytes();
    EXPECT_TRUE(says(refusal_of('\0' + sound.substr(1), as("c3d")), {"block 0"}));
    EXPECT_TRUE(says(refusal_of(patched(sound, "SCALE", 3, "\x09")), {"'SCALE' has 9 dimensions"}));
    EXPECT_TRUE(says(refusal_of(patched(sound, "SCALE", 0, sample.integer(1))), {"after the parameter 'SCALE'"}));
    EXPECT_TRUE(
        says(refusal_of(patched(sound, "DATA_START", 4, sample.integer(1))), {"POINT:DATA_START is 1", "from 2"}));
    C3dSample no_analogs;
    no_analogs.has_analogs = false;
    EXPECT_TRUE(
        says(refusal_of(patched(no_analogs.bytes(), "USED", 4, sample.integer(0))), {"neither points nor analogs"}));
    std::string no_frames = patched(sound, "FRAMES", 4, sample.integer(0));
    no_frames.replace(8, 2, sample.integer(0));
    EXPECT_TRUE(says(refusal_of(no_frames), {"the number of frames is 0"}));
    const std::size_t used = sound.find("USED", sound.find("USED") + 1);
    std::string no_channels = sound;
    no_channels.replace(used + 8, 2, sample.integer(0));
    EXPECT_TRUE(says(refusal_of(no_channels), {"4 analog numbers a frame", "no channel is named"}));
}

TEST(Messages, OfMotionCapture) {
    EXPECT_TRUE(says(refusal_of(replaced(vicon_sample, "Frame,Sub Frame,Fx", "Image,Sub,Fx")), {"'Frame, Sub Frame'"}));
    EXPECT_TRUE(says(refusal_of("Devices\n200\n,,a\nFrame,Sub Frame,F\n,,N\n\n\n"), {"'devices' holds no rows"}));
    EXPECT_TRUE(says(refusal_of(replaced(vicon_sample, "2,0,1.1", ",0,1.1")), {"frame's number is missing"}));
    EXPECT_TRUE(says(refusal_of(replaced(vicon_sample, "X,Y,Z,X,Y,Z", "A,B,C,A,B,C")), {"no columns X, Y, Z"}));
    EXPECT_TRUE(says(refusal_of(replaced(trc_sample, "\tBase\t\t\tTip", "")), {"names no markers"}));
    EXPECT_TRUE(says(refusal_of(trc_sample.substr(0, trc_sample.find("1\t0\t"))), {"holds no frame"}));
    EXPECT_TRUE(
        says(refusal_of(replaced(trc_sample, "4\t5\t6\n", "4\t5\t6\t7\n")), {"line 7", "9 cells", "8 columns"}));
    EXPECT_TRUE(says(refusal_of(motive_sample.substr(0, motive_sample.find("0,0.000000"))), {"holds no frame"}));
    std::string rows, wide = "PathFileType\nUnits\nmm\nFrame#\tTime";
    for (int m = 0; m < 2000; ++m) wide += "\tm" + std::to_string(m);
    for (int f = 0; f < 400; ++f) rows += "\n" + std::to_string(f);
    EXPECT_TRUE(says(refusal_of(wide + "\n" + rows), {"6002 columns", "hardly any cells"}));
}

TEST(Messages, OfRowsForPoints) {
    EXPECT_TRUE(says(refusal_of("frame,marker,x,y,z\nA,1,1,2,3\nB,1,1,2,3\n"), {"'frame' of frames holds texts"}));
    FileMap map;
    map.point_column = ColumnPlace{"id", ""};
    map.points = {{"any", {{"a", ""}, {"b", ""}}, {}}};
    EXPECT_TRUE(says(refusal_of("id,a,b\n1,2,x\n2,3,y\n", map), {"'b' holds texts"}));
    std::string sparse = "frame,marker,x,y,z\n";
    for (int i = 0; i < 1500; ++i) sparse += std::to_string(i) + "," + std::to_string(i) + ",1,2,3\n";
    EXPECT_TRUE(says(refusal_of(sparse), {"1500 frames and 1500 points", "1500 rows"}));
}

TEST(Messages, OfRowsThatAreFarTooWide) {
    std::string text, wide;
    for (int i = 0; i < 5000; ++i) wide += "1,";
    for (int i = 0; i < 5000; ++i) text += i == 2500 ? wide + "1\n" : "1,2\n";
    EXPECT_TRUE(says(refusal_of(text), {"5001 cells", "far fewer"}));
}

TEST(Messages, OfSheets) {
    const TemporaryFolder folder;
    folder.write("x.dat", "1 2\n3 4\n");
    folder.write("y.dat", "1 2\n3 4\n");
    folder.write("t.dat", "1 a b\n3 c d\n5 6 7\n");
    folder.write("b.dat", std::string("\1\0\3\7\0\0", 6));
    const auto refusal = [&](const FileMap& map) {
        return message_of([&] { read_recordings(folder / "x.dat", map); });
    };
    FileMap map;
    map.sheets = MappedSheets{{"x.dat", "y.dat"}, {}, false};
    map.names = {"one"};
    EXPECT_TRUE(says(refusal(map), {"1 names", "2 points"}));
    map.sheets->at = {"b.dat", "y.dat"};
    EXPECT_TRUE(says(refusal(map), {"b.dat", "no text"}));
    map.header_lines = 0;
    map.delimiter = ' ';
    map.sheets->at = {"t.dat", "y.dat"};
    EXPECT_FALSE(refusal(map).empty());
}

TEST(Messages, OfScansAndSeries) {
    EXPECT_TRUE(
        says(refusal_of("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
                        "z\nend_header\n"),
             {"holds no points"}));
    const TemporaryFolder folder;
    EXPECT_TRUE(says(message_of<IoError>([&] { read_recordings(folder.path()); }), {"no files in this folder"}));
}

TEST(Messages, OfMatlabFiles) {
    const TemporaryFolder folder;
    const auto refusal = [](const std::filesystem::path& file) { return message_of([&] { read_recordings(file); }); };
    EXPECT_TRUE(says(refusal(write_ncorr(folder / "a.mat", -3)), {"spacing is -3"}));
    EXPECT_TRUE(says(refusal(write_ncorr(folder / "b.mat", 4, false)), {"frame 2", "another size"}));
    EXPECT_TRUE(says(refusal(write_multidic(folder / "c.mat", false)), {"frame 2", "3 x 2", "2 x 3"}));
}

}  // namespace
}  // namespace palpate::identify
