// Whatever stands in a file, it is read or refused: broken by chance, hundreds of times each.

#include <gtest/gtest.h>

#include <functional>

#include "identify/recordings/files/draft_map.h"
#include "identify/recordings/files/read_recordings.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "tests/fuzz/mutations.h"
#include "tests/identify/recordings/c3d_sample.h"
#include "tests/identify/recordings/exodus_sample.h"
#include "tests/identify/recordings/mat_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

struct Sample {
    const char* name;
    std::string file;
    std::function<std::string()> content;
};

void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.name; }

class BrokenFiles : public testing::TestWithParam<Sample> {};

TEST_P(BrokenFiles, AreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string sound = GetParam().content();
    const auto file = folder.write(GetParam().file, sound);
    ASSERT_NO_THROW(read_recordings(file));
    std::mt19937_64 random(41);
    int refused = 0;
    for (int i = 0; i < fuzz::inputs(300); ++i) {
        const std::string broken = fuzz::mutated(sound, random);
        mesh::write_text(file, broken);
        try {
            const auto recordings = read_recordings(file);
            // What is read is whole: all of it has the same frames.
            for (const Recording& recording : recordings) {
                for (const RecordedPoint& point : recording.points) ASSERT_EQ(point.at.cols(), recording.times.size());
                for (const RecordedChannel& channel : recording.channels)
                    ASSERT_EQ(channel.values.size(), recording.times.size());
                ASSERT_TRUE(recording.times.allFinite());
                ASSERT_TRUE(std::is_sorted(recording.times.begin(), recording.times.end()));
            }
        } catch (const InvalidInput& error) {
            ++refused;
            EXPECT_GT(std::string(error.what()).size(), 20u);  // a sentence, not a word
        } catch (const IoError&) {
            ++refused;
        } catch (const std::exception& error) {
            const auto kept = std::filesystem::temp_directory_path() / ("palpate-broken-" + GetParam().file);
            mesh::write_text(kept, broken);
            FAIL() << error.what() << " instead of a refusal, at input " << i << ": " << kept;
        }
    }
    RecordProperty("refused", refused);
    EXPECT_GT(refused, 0);  // or the mutations break nothing
}

std::string bytes_of(const std::function<std::filesystem::path(const std::filesystem::path&)>& write) {
    const TemporaryFolder folder;
    return mesh::read_text(write(folder / "a"));
}

std::string c3d(C3dSample::Processor processor, bool has_reals) {
    C3dSample sample(processor);
    sample.has_reals = has_reals;
    return sample.bytes();
}

std::function<std::string()> text(const std::string& content) {
    return [=] { return content; };
}

INSTANTIATE_TEST_SUITE_P(
    Of, BrokenFiles,
    testing::Values(
        Sample{"c3d", "run.c3d", [] { return c3d(C3dSample::Processor::intel, true); }},
        Sample{"c3d_dec", "run.c3d", [] { return c3d(C3dSample::Processor::dec, false); }},
        Sample{"c3d_mips", "run.c3d", [] { return c3d(C3dSample::Processor::mips, true); }},
        Sample{"trc", "run.trc", text(trc_sample)}, Sample{"motive", "take.csv", text(motive_sample)},
        Sample{"vicon", "trial.csv", text(vicon_sample)}, Sample{"bluehill", "pull.csv", text(bluehill_sample)},
        Sample{"zwick", "zug.tra", text(zwick_sample)}, Sample{"dice", "dice.txt", text(dice_sample)},
        Sample{"aramis", "aramis.txt", text(aramis_sample)}, Sample{"vic", "vic.csv", text(vic_sample)},
        Sample{"long_table", "long.csv", text(long_sample)}, Sample{"ply", "scan.ply", text(ply_sample)},
        Sample{"vtk", "scan.vtk", text(vtk_sample)},
        Sample{"table", "t.csv", text("0,0.000,1,2,3,4,5,6\n1,0.005,1,2,3,4,5,6\n2,0.010,1,2,3,4,5,7\n")},
        Sample{"clock", "t.csv", text("time;F [N]\n12:00:01,5;1,5\n12:00:02,5;2,5\n12:00:03,5;2,25\n")},
        Sample{"ncorr", "dic.mat", [] { return bytes_of([](const auto& file) { return write_ncorr(file); }); }},
        Sample{"exodus", "dic.e", [] { return bytes_of([](const auto& file) { return write_exodus(file, {}); }); }},
        Sample{"multidic", "dic.mat", [] { return bytes_of([](const auto& file) { return write_multidic(file); }); }}),
    [](const testing::TestParamInfo<Sample>& each) { return each.param.name; });

}  // namespace
}  // namespace palpate::identify
