#include "mesh/formats/surface/surface_formats.h"

#include <gtest/gtest.h>

#include <set>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

TEST(SurfaceFormats, AreToldByDifferentExtensionsInLowerCase) {
    std::set<std::string> extensions;
    for (const SurfaceFormat& format : surface_formats()) {
        const std::string extension = format.extension;
        EXPECT_TRUE(extensions.insert(extension).second) << extension;
        EXPECT_EQ(surface_format_of("body" + extension), &format) << extension << " begins with a dot, in lower case";
        EXPECT_TRUE(is_body_file("body" + extension)) << extension;
        EXPECT_EQ(body_name("a/body" + extension), "body");
    }
    EXPECT_EQ(surface_format_of("body.STL"), surface_format_of("body.stl"));
    EXPECT_EQ(surface_format_of("body"), nullptr);
    EXPECT_EQ(surface_format_of(".stl"), nullptr);
}

TEST(SurfaceFormats, AreReadAsBodiesAsTheyWereWrittenOrAreNotWritten) {
    const TemporaryFolder folder;
    const Surface box = make_box({0, 0, 0}, {30, 20, 10}, {2, 1, 1});
    for (const SurfaceFormat& format : surface_formats()) {
        const std::filesystem::path file = folder / (std::string("box") + format.extension);
        if (!format.write) {
            EXPECT_TRUE(says(message_of([&] { write_surface(file, box); }), {"written", format.extension, ".stl"}));
            EXPECT_FALSE(std::filesystem::exists(file));
            continue;
        }
        write_surface(file, box);
        const Surface read = read_body(file).surface;
        EXPECT_EQ(read.triangles.rows(), box.triangles.rows()) << format.extension;
        // Every format holds these coordinates exactly; the sum over triangles rounds.
        EXPECT_NEAR(signed_volume(read), signed_volume(box), 1e-9 * signed_volume(box)) << format.extension;
    }
}

TEST(SurfaceFormats, RefuseABrokenFileWithItsName) {
    const TemporaryFolder folder;
    for (const SurfaceFormat& format : surface_formats()) {
        const std::string name = std::string("broken") + format.extension;
        for (const char* text : {" \n", "no surface of any kind\n"}) {
            const auto file = folder.write(name, text);
            EXPECT_TRUE(says(message_of([&] { read_surface(file); }), {name.c_str()}));
            EXPECT_TRUE(says(message_of([&] { read_body(file); }), {name.c_str()}));
        }
    }
}

TEST(SurfaceFormats, AreListedWhereAnExtensionNamesNone) {
    const TemporaryFolder folder;
    const auto file = folder.write("body.txt", "v 0 0 0\n");
    const std::string read = surface_extensions(), written = written_surface_extensions();
    for (const SurfaceFormat& format : surface_formats()) {
        EXPECT_NE((", " + read + ",").find(std::string(" ") + format.extension + ","), std::string::npos);
        EXPECT_EQ((", " + written + ",").find(std::string(" ") + format.extension + ",") != std::string::npos,
                  format.write != nullptr);
    }
    EXPECT_TRUE(says(message_of([&] { read_surface(file); }), {"body.txt", "'.txt'", "no surface", read.c_str()}));
    EXPECT_TRUE(says(message_of([&] { read_body(file); }), {"body.txt", "'.txt'", "no kind of body", read.c_str()}));
    EXPECT_TRUE(says(message_of([&] {
                         write_surface(file, make_sphere({0, 0, 0}, 1, 1));
                     }),
                     {"body.txt", "'.txt'", "written", written.c_str()}));
    EXPECT_EQ(read_text(file), "v 0 0 0\n");
}

}  // namespace
}  // namespace palpate::mesh
