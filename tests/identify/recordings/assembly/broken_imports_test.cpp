// Whatever stands in a map, a recording or a mesh: an import comes to a set or says what is wrong.

#include <random>

#include "mesh/text/atomic_file.h"
#include "tests/fuzz/mutations.h"
#include "tests/identify/recordings/assembly/rig_of_a_bar.h"

namespace palpate::identify {
namespace {

TEST_F(RigOfABar, BrokenInTwoHundredWaysIsTakenOrRefused) {
    // short ones: each is read two hundred times
    const auto shorten = [&](const char* name, std::size_t lines, std::size_t every) {
        const std::string text = mesh::read_text(folder / name);
        std::string kept;
        std::size_t line = 0;
        for (std::size_t at = 0; at < text.size() && line < lines; ++line) {
            const std::size_t end = text.find('\n', at) + 1;
            if (line % every == 0) kept += text.substr(at, end - at);
            at = end;
        }
        folder.write(name, kept);
    };
    shorten("points.csv", 900, 5);
    shorten("load.csv", 8000, 20);
    ASSERT_NO_THROW(imported());
    const char* names[]{"map.yaml", "map.yaml", "points.csv", "load.csv", "bar.stl"};
    std::vector<std::string> sound;
    for (const char* name : names) sound.push_back(mesh::read_text(folder / name));
    int refused = 0, taken = 0;
    const int inputs = fuzz::inputs(200);
    for (int i = 0; i < inputs; ++i) {
        std::mt19937_64 random(static_cast<std::uint64_t>(i));
        const std::size_t which = static_cast<std::size_t>(i) % std::size(names);
        folder.write(names[which], fuzz::mutated(sound[which], random));
        try {
            const ImportedSet got = imported();
            EXPECT_FALSE(got.set.states.empty()) << i;
            write_measurement_set(folder / "set", got.set);
            ++taken;
        } catch (const InvalidInput& error) {
            EXPECT_GT(std::string(error.what()).size(), 20U) << i;  // a sentence, not a word
            ++refused;
        } catch (const IoError& error) {
            EXPECT_GT(std::string(error.what()).size(), 20U) << i;  // a sentence, not a word
            ++refused;
        }
        folder.write(names[which], sound[which]);
    }
    // neither all nor none, or the mutations would tell nothing: four fifths are refused
    EXPECT_GT(refused, inputs / 2);
    EXPECT_GT(taken, inputs / 10);
}

}  // namespace
}  // namespace palpate::identify
