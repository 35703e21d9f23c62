// What a set is read as before anything is fitted: its weight as the load, tetrahedra of its own.

#include "pipeline/case/subject/weight.h"

#include <gtest/gtest.h>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/command_line/commands.h"
#include "tests/messages.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

/// The measured beam of silicone, with nothing hung from it: it sags by 6.5 mm along -z.
identify::MeasurementSet sagging_beam() {
    auto set = identify::read_measurement_set(std::filesystem::path(samples_folder) / "dragonskin-beam");
    std::erase_if(set.states, [](const identify::LoadState& state) {
        return std::ranges::any_of(state.contacts, [](const mesh::Contact& c) { return !c.force.isZero(0); });
    });
    return set;
}

TEST(Weight, IsTheLoadWhereNothingElseActs) {
    identify::MeasurementSet set = sagging_beam();
    std::vector<std::string> notes;
    take_weight_as_load(set, notes);
    ASSERT_TRUE(set.gravity);
    EXPECT_LT((*set.gravity - Vec3(0, 0, -9806.65)).norm(), 1e-9) << set.gravity->transpose();
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_TRUE(says(notes[0], {"No state has a load", "weight", "(0.000, 0.000, -1.000)"}));
}

TEST(Weight, IsLeftAloneBesideALoadOrWithoutAMaterial) {
    std::vector<std::string> notes;
    identify::MeasurementSet known = sagging_beam();
    known.gravity = Vec3(0, -1, 0);
    take_weight_as_load(known, notes);
    EXPECT_EQ(*known.gravity, Vec3(0, -1, 0));
    identify::MeasurementSet nothing_told = sagging_beam();
    nothing_told.density.reset();
    nothing_told.material.reset();
    take_weight_as_load(nothing_told, notes);
    EXPECT_FALSE(nothing_told.gravity);
    identify::MeasurementSet pressed =
        identify::read_measurement_set(std::filesystem::path(samples_folder) / "dragonskin-beam");
    take_weight_as_load(pressed, notes);
    EXPECT_FALSE(pressed.gravity);
    EXPECT_TRUE(notes.empty());
}

TEST(OwnTetrahedra, StayWhenASetIsReadWrittenAndComputedOn) {
    const TemporaryFolder folder;
    identify::MeasurementSet set = sagging_beam();
    const mesh::VolumeMesh bar = mesh::make_bar({-100, 0, 0}, {0, 30, 30}, {7, 2, 2});
    set.rest_volume = bar;
    set.rest_surface = mesh::boundary_surface(bar);
    identify::write_measurement_set(folder / "set", set);
    const auto read = identify::read_measurement_set(folder / "set");
    ASSERT_TRUE(read.rest_volume);
    EXPECT_EQ(read.rest_volume->tetrahedra.rows(), bar.tetrahedra.rows());
    EXPECT_EQ(read.rest_volume->nodes.rows(), bar.nodes.rows());
    const Reference reference = make_reference(read, 5);
    ASSERT_TRUE(reference.body) << reference.why_none;
    EXPECT_EQ(reference.body->dofs(), 3 * mesh::to_quadratic(bar).nodes.rows());
    EXPECT_TRUE(says(reference.notes.front(), {"the set's own", "168 tetrahedra"}));
}

TEST(Check, TellsWhatReadingsAreGoodFor) {
    const commands::Outcome outcome = commands::check(
        {.input = std::filesystem::path(samples_folder) / "dragonskin-beam", .output = {}, .overrides = {}}, {});
    EXPECT_TRUE(says(outcome.text, {"measured coordinates", "independent data"}));
    EXPECT_GT(outcome.json["independent_readings"].get<int>(), 3);
}

}  // namespace
}  // namespace palpate::pipeline
