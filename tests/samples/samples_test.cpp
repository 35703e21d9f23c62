// Every sample keeps what it promises, and is what our own code makes.

#include <gtest/gtest.h>

#include <filesystem>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "samples/lattice.h"
#include "samples/organ.h"
#include "skeleton/model/io/model_io.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> sample_names() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(samples_folder)) {
        if (fs::exists(entry.path() / "case.yaml")) names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

class Sample : public ::testing::TestWithParam<std::string> {};

TEST_P(Sample, KeepsWhatItPromises) {
    const TemporaryFolder scratch;
    const commands::Outcome outcome = commands::run(
        {.input = fs::path(samples_folder) / GetParam() / "case.yaml", .output = scratch / "run", .overrides = {}},
        {.json = false, .force = false, .threads = 2, .seed = {}});
    EXPECT_EQ(outcome.code, commands::done) << outcome.json["expectations_not_met"];
}

INSTANTIATE_TEST_SUITE_P(All, Sample, ::testing::ValuesIn(sample_names()), [](const auto& named) {
    std::string name = named.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

/// The committed sets of the paper's experiments are those that the code makes. Equilibria are found to 1e-9 of the
/// load.
TEST(Experiments, AreWhatTheirCodeMakes) {
    for (const samples::Experiment& experiment :
         {samples::make_cube_experiment(), samples::make_sheet_experiment(), samples::make_two_strings()}) {
        const fs::path folder = fs::path(samples_folder) / experiment.start.name;
        const identify::MeasurementSet committed = identify::read_measurement_set(folder / "set");
        ASSERT_EQ(committed.states.size(), experiment.set.states.size());
        for (std::size_t s = 0; s < committed.states.size(); ++s) {
            const auto& readings = experiment.set.states[s].readings;
            ASSERT_EQ(committed.states[s].readings.size(), readings.size());
            for (std::size_t r = 0; r < readings.size(); ++r) {
                const Vec3 off = committed.states[s].readings[r].position - readings[r].position;
                EXPECT_NEAR(off.array().isNaN().select(0, off).norm(), 0, 1e-6);
            }
        }
        EXPECT_EQ(skeleton::read_model(folder / "start.json").links.size(), experiment.start.links.size());
    }
}

/// The committed organ is the one that the code makes, to the single precision that STL holds.
TEST(Organ, IsWhatItsCodeMakes) {
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "organ.stl", samples::make_organ());
    EXPECT_EQ(mesh::read_text(scratch / "organ.stl"), mesh::read_text(fs::path(samples_folder) / "organ/organ.stl"));
}

}  // namespace
}  // namespace palpate::pipeline
