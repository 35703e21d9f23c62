// What a user can get wrong: one clear message each, exit code 3, nothing half-written.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "pipeline/command_line/commands.h"
#include "samples/lattice.h"
#include "skeleton/model/io/model_io.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The message of a run on `input`; nothing may stand in the run folder afterwards.
std::string message_of_run(const TemporaryFolder& scratch, const std::filesystem::path& input) {
    std::string message;
    try {
        commands::run({.input = input, .output = scratch / "run", .overrides = {}}, {});
    } catch (const InvalidInput& e) {
        message = e.what();
    } catch (const IoError& e) {
        message = e.what();
    }
    EXPECT_FALSE(std::filesystem::exists(scratch / "run/mesh")) << "something was half-written";
    return message;
}

const std::string box_obj =
    "v 0 0 0\nv 100 0 0\nv 100 20 0\nv 0 20 0\nv 0 0 20\nv 100 0 20\nv 100 20 20\nv 0 20 20\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(BadInput, MissingFile) {
    const TemporaryFolder scratch;
    EXPECT_THAT(message_of_run(scratch, scratch / "none.stl"), AllOf(HasSubstr("none.stl"), HasSubstr("no such file")));
}

TEST(BadInput, FilesThatBrokeTheProgramOnceAreRefused) {
    const char* data = std::getenv("PALPATE_DATA");
    if (!data) GTEST_SKIP() << "PALPATE_DATA names no folder with hostile files";
    const std::filesystem::path folder = std::filesystem::path(data) / "hostile";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const TemporaryFolder scratch;
        const bool is_deck = std::filesystem::exists(entry.path() / "a0.inp");
        const std::string message = message_of_run(scratch, is_deck ? entry.path() / "a0.inp" : entry.path());
        EXPECT_GT(message.size(), 40U) << entry.path() << " is taken: " << message;
    }
}

TEST(BadInput, EmptyFile) {
    const TemporaryFolder scratch;
    EXPECT_THAT(message_of_run(scratch, scratch.write("empty.stl", "")),
                AllOf(HasSubstr("empty.stl"), HasSubstr("empty")));
}

TEST(BadInput, TruncatedStl) {
    const TemporaryFolder scratch;
    const auto whole = scratch / "box.stl";
    mesh::write_surface(whole, mesh::make_box({0, 0, 0}, {100, 20, 20}, {2, 1, 1}));
    std::filesystem::resize_file(whole, std::filesystem::file_size(whole) - 30);
    EXPECT_THAT(message_of_run(scratch, whole), AllOf(HasSubstr("box.stl"), HasSubstr("triangles")));
}

TEST(BadInput, TextInPlaceOfAMesh) {
    const TemporaryFolder scratch;
    EXPECT_THAT(message_of_run(scratch, scratch.write("letter.stl", "Dear all,\nplease find the mesh attached.\n")),
                HasSubstr("letter.stl"));
}

TEST(BadInput, CoordinateThatIsNoNumber) {
    const TemporaryFolder scratch;
    std::string text = box_obj;
    text.replace(text.find("v 100 20 0"), 10, "v 100 nan 0");
    EXPECT_THAT(message_of_run(scratch, scratch.write("box.obj", text)),
                AllOf(HasSubstr("box.obj"), HasSubstr("line 3")));
}

TEST(BadInput, IndexOutOfRange) {
    const TemporaryFolder scratch;
    std::string text = box_obj;
    text.replace(text.find("f 5 6 7 8"), 9, "f 5 6 7 99");
    EXPECT_THAT(message_of_run(scratch, scratch.write("box.obj", text)),
                AllOf(HasSubstr("box.obj"), HasSubstr("line 10"), HasSubstr("99")));
}

TEST(BadInput, UnknownKindOfFile) {
    const TemporaryFolder scratch;
    EXPECT_THAT(message_of_run(scratch, scratch.write("body.docx", "x")),
                AllOf(HasSubstr("body.docx"), HasSubstr(".stl")));
}

TEST(BadInput, UnknownKeyIsNamedWithItsNeighbour) {
    const TemporaryFolder scratch;
    scratch.write("box.obj", box_obj);
    const auto file = scratch.write("case.yaml", "format: palpate-case/1\nmesh: box.obj\nskeleton: {shperes: 12}\n");
    EXPECT_THAT(message_of_run(scratch, file),
                AllOf(HasSubstr("case.yaml"), HasSubstr("line 3"), HasSubstr("shperes"), HasSubstr("spheres")));
}

TEST(BadInput, YamlAliasBombIsRefused) {
    const TemporaryFolder scratch;
    std::string bomb = "format: palpate-case/1\na: &a [x, x, x, x, x, x, x, x, x]\n";
    for (char c = 'b'; c <= 'j'; ++c) {
        bomb += std::string(1, c) + ": &" + c + " [";
        for (int i = 0; i < 9; ++i) bomb += std::string(i ? "," : "") + "*" + static_cast<char>(c - 1);
        bomb += "]\n";
    }
    EXPECT_THAT(message_of_run(scratch, scratch.write("case.yaml", bomb)),
                AllOf(HasSubstr("case.yaml"), HasSubstr("alias")));
}

TEST(BadInput, NoSupports) {
    const TemporaryFolder scratch;
    scratch.write("box.obj", box_obj);
    const auto file = scratch.write("case.yaml", "format: palpate-case/1\nmesh: box.obj\nsupports: []\n");
    EXPECT_THAT(message_of_run(scratch, file), AllOf(HasSubstr("case.yaml"), HasSubstr("supports"), HasSubstr("held")));
}

TEST(BadInput, MeshAndMeasurementsTogether) {
    const TemporaryFolder scratch;
    const auto file = scratch.write("case.yaml", "format: palpate-case/1\nmesh: a.stl\nmeasurements: b\n");
    EXPECT_THAT(message_of_run(scratch, file), HasSubstr("not both"));
}

TEST(BadInput, ProbeOffTheSurface) {
    const TemporaryFolder scratch;
    scratch.write("set/rest.obj", box_obj);
    scratch.write("set/set.yaml",
                  "format: palpate-measurements/1\nrest_surface: rest.obj\nsupports:\n  - box: {min: [-1, -1, -1], "
                  "max: [1, 21, 21]}\n");
    scratch.write("set/probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n7,0,100,10,400,0,0,-1,3\n");
    scratch.write("set/markers.csv", "marker,x,y,z\n0,100,10,20\n");
    scratch.write("set/positions.csv", "probe,time,marker,x,y,z\n7,0,0,100,10,18\n");
    EXPECT_THAT(message_of_run(scratch, scratch / "set"), AllOf(HasSubstr("probe 7"), HasSubstr("mm")));
}

TEST(BadInput, APipeIsNoFile) {
    const TemporaryFolder scratch;
    const auto pipe = scratch / "case.yaml";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THAT(message_of_run(scratch, pipe), AllOf(HasSubstr("case.yaml"), HasSubstr("pipe")));
}

TEST(BadInput, SupportsThatHoldAll) {
    const TemporaryFolder scratch;
    skeleton::Model model = samples::make_lattice("bar", {3, 1, 1}, 1);
    skeleton::write_model(scratch / "model.json", model);
    identify::MeasurementSet set;
    set.rest_surface = mesh::make_box({-20, -20, -20}, {100, 20, 20}, {3, 1, 1});
    set.supports = {mesh::BoxRegion{Vec3::Constant(-1e3), Vec3::Constant(1e3)}};
    set.markers = {{0, Vec3(80, 0, 20), std::nullopt}};
    set.states = {{.probe = 1, .contacts = {{Vec3(80, 0, 20), Vec3(0, 0, -1), 0}}, .readings = {{0, Vec3(80, 0, 19)}}}};
    identify::write_measurement_set(scratch / "set", set);
    commands::IdentifyCommandOptions options;
    options.model = scratch / "model.json";
    options.set = scratch / "set";
    options.output = scratch / "out";
    EXPECT_TRUE(
        says(message_of([&] { commands::identify(options, {}); }), {"hold all 3 spheres", "nothing is left to move"}));
}

TEST(BadInput, FolderOfSomebodyElse) {
    const TemporaryFolder scratch;
    const auto input = scratch.write("box.obj", box_obj);
    scratch.write("run/thesis.tex", "years of work");
    EXPECT_THAT(message_of_run(scratch, input), AllOf(HasSubstr("did not make"), HasSubstr("--force")));
}

TEST(BadInput, FileOfSomebodyElseIsNotReplaced) {
    const TemporaryFolder scratch;
    const auto input = scratch.write("box.obj", box_obj);
    const auto precious = scratch.write("body.vtu", "somebody's");
    EXPECT_THROW(commands::mesh_body({.input = input, .output = precious, .overrides = {}}, {}), InvalidInput);
    EXPECT_EQ(std::filesystem::file_size(precious), 10U);
}

/// A surface that encloses nothing is refused after reading, before anything is written for it.
TEST(BadInput, OpenSheetEnclosesNothing) {
    const TemporaryFolder scratch;
    const auto input = scratch.write("sheet.obj", "v 0 0 0\nv 100 0 0\nv 100 50 0\nv 0 50 0\nf 1 2 3 4\n");
    std::string message;
    try {
        commands::mesh_body({.input = input, .output = scratch / "body.vtu", .overrides = {}}, {});
    } catch (const InvalidInput& e) {
        message = e.what();
    }
    EXPECT_THAT(message, HasSubstr("enclose"));
    EXPECT_FALSE(std::filesystem::exists(scratch / "body.vtu"));
}

}  // namespace
}  // namespace palpate::pipeline
