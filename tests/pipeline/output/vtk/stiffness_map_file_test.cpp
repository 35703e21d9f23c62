// What a map of stiffness leaves behind: a field for ParaView, and a set whose regions are its parts.

#include "pipeline/output/vtk/stiffness_map_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "identify/effects/catalogue.h"
#include "mesh/geometry/sampling.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

/// A diagnosis that names a map of four places along x, 20 mm apart.
identify::Diagnosis with_map(const std::vector<double>& amplitudes) {
    const auto map = identify::find_effect("map");
    std::vector<identify::EffectNumber> numbers{{.name = "length", .unit = "mm", .logarithm = true}};
    Eigen::VectorXd values(1 + 4 * std::ssize(amplitudes));
    values.setZero();
    values[0] = std::log(5);
    for (Eigen::Index i = 0; i < std::ssize(amplitudes); ++i) {
        for (const char* name : {"x", "y", "z", "a"})
            numbers.push_back({.name = name + std::to_string(i + 1), .unit = ""});
        values[1 + 4 * i] = 20.0 * static_cast<double>(i);
        values[4 + 4 * i] = amplitudes[static_cast<std::size_t>(i)];
    }
    identify::FittedExplanation explained{.effects = {map}, .fit = {}};
    explained.fit.explanation.effects = {map};
    explained.fit.explanation.values = {values};
    explained.fit.numbers = {numbers};
    explained.fit.covariance = explained.fit.scatter = 1e-6 * Eigen::MatrixXd::Identity(values.size(), values.size());
    identify::Diagnosis diagnosis;
    diagnosis.explained = explained;
    return diagnosis;
}

class StiffnessMapFile : public testing::Test {
protected:
    StiffnessMapFile() {
        set_.name = "bar";
        set_.rest_surface = mesh::boundary_surface(bar_);
        set_.supports = {mesh::BoxRegion{Vec3(-11, -6, -6), Vec3(-9, 6, 6)}};
        set_.position_noise = 0.1;
        set_.markers.resize(1);
        set_.markers[0].id = 1;
        set_.markers[0].rest = Vec3(70, 0, 0);
        identify::LoadState state;
        state.probe = 1;
        state.contacts = {{.point = Vec3(70, 0, 5), .force = Vec3(0, 0, -1), .radius = 2}};
        state.readings = {{.marker = 0, .position = Vec3(70, 0, -1), .sigma = 0.1}};
        set_.states = {state};
    }
    const mesh::VolumeMesh bar_ = mesh::make_bar(Vec3(-10, -5, -5), Vec3(70, 5, 5), {32, 4, 4});
    identify::MeasurementSet set_;
    TemporaryFolder scratch_;
};

TEST_F(StiffnessMapFile, ItsPartsAreRegionsOfASetToRunNext) {
    ASSERT_TRUE(write_stiffness_map(scratch_.path(), bar_, set_, with_map({1.2, 0, 0, -1.2})));
    EXPECT_TRUE(fs::exists(scratch_ / "map.vtu"));
    const identify::MeasurementSet next = identify::read_measurement_set(scratch_ / map_regions);
    ASSERT_TRUE(next.rest_volume);
    EXPECT_EQ(next.rest_volume->tetrahedra.rows(), bar_.tetrahedra.rows());
    ASSERT_EQ(next.regions.size(), 2U);
    const double border = 10 + 50 * std::log(3) / 80;  // see the test of part_of_elements()
    const double cell = 2.5 * 100;                     // mm^3, of a slice of elements
    for (const mesh::MaterialRegion& region : next.regions) {
        EXPECT_FALSE(region.young) << "to be identified";
        EXPECT_NEAR(std::abs(mesh::signed_volume(region.surface)), (10 + border) * 100, cell);
    }
    EXPECT_LT(next.regions[0].surface.vertices.col(0).maxCoeff(), 14);
    EXPECT_GT(next.regions[1].surface.vertices.col(0).minCoeff(), 46);
    EXPECT_EQ(next.states.size(), 1U);
}

TEST_F(StiffnessMapFile, ASetWithRegionsKeepsThem) {
    set_.regions = {{.name = "bone", .surface = mesh::make_box({0, -2, -2}, {9, 2, 2}, {2, 1, 1}), .young = 3}};
    EXPECT_FALSE(write_stiffness_map(scratch_.path(), bar_, set_, with_map({1.2, 0, 0, -1.2})));
    EXPECT_TRUE(fs::exists(scratch_ / "map.vtu"));
    EXPECT_FALSE(fs::exists(scratch_ / map_regions));
}

TEST_F(StiffnessMapFile, AFlatMapHasNoParts) {
    EXPECT_FALSE(write_stiffness_map(scratch_.path(), bar_, set_, with_map({0.1, 0, 0, -0.1})));
    EXPECT_TRUE(fs::exists(scratch_ / "map.vtu"));
    EXPECT_FALSE(fs::exists(scratch_ / map_regions));
}

/// What an earlier diagnosis left there would be taken for what this one found.
TEST_F(StiffnessMapFile, WithoutAMapNothingStays) {
    ASSERT_TRUE(write_stiffness_map(scratch_.path(), bar_, set_, with_map({1.2, 0, 0, -1.2})));
    EXPECT_FALSE(write_stiffness_map(scratch_.path(), bar_, set_, {}));
    EXPECT_FALSE(fs::exists(scratch_ / "map.vtu"));
    EXPECT_FALSE(fs::exists(scratch_ / map_regions));
}

}  // namespace
}  // namespace palpate::pipeline
