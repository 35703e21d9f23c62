#include "identify/inference/domains/force/node_configuration.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "mesh/formats/vtk/vtk_files.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

Points some_points() {
    Points x(5, 3);
    x << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 1, 1, 1, 1;
    return x;
}

TEST(RigidFit, FindsARigidMotionExactly) {
    const Points x = some_points();
    const Mat3 R = skeleton::rotation({0.5, -1.2, 2});
    const Vec3 d(4, -5, 6);
    const Points y = (x * R.transpose()).rowwise() + d.transpose();
    const RigidFit fit = fit_rigid(x, y);
    ASSERT_TRUE(fit.unique);
    EXPECT_LT((fit.R - R).norm(), 1e-12);  // rounding
    EXPECT_LT((fit.R * (Vec3(7, 8, 9) - fit.c) + fit.d - R * Vec3(7, 8, 9) - d).norm(), 1e-11);
}

TEST(RigidFit, IsARotationEvenFromAMirrorImage) {
    Points y = some_points();
    y.col(0) *= -1;
    EXPECT_NEAR(fit_rigid(some_points(), y).R.determinant(), 1, 1e-12);  // rounding
}

TEST(RigidFit, PointsInLineTellNoRotation) {
    Points x(4, 3);
    x << 0, 0, 0, 1, 1, 1, 2, 2, 2, 5, 5, 5;
    EXPECT_FALSE(fit_rigid(x, x).unique);
    EXPECT_FALSE(fit_rigid(x.topRows(2), x.topRows(2)).unique);
}

TEST(NodeConfiguration, MarkersOnSpheresTellTheTwinsConfiguration) {
    const skeleton::Model model = make_lattice({3, 2, 2});
    const MeasurementSet set =
        simulate_measurements(model, push_spheres(model, six_forces(6, 6)), markers_on_spheres(model));
    const std::vector<MeasuredConfiguration> measured = measured_configurations(model, set);
    ASSERT_EQ(measured.size(), 6U);
    for (const MeasuredConfiguration& configuration : measured) {
        const skeleton::Equilibrium truth = equilibrium(model, configuration.load);
        EXPECT_LT((configuration.state.x - truth.state.x).norm(), 1e-9);  // rounding of coordinates of some 100 mm
        for (std::size_t i = 0; i < truth.state.R.size(); ++i) {
            EXPECT_LT((configuration.state.R[i] - truth.state.R[i]).norm(), 1e-9);
        }
    }
}

TEST(NodeConfiguration, ASphereWithTwoReadingsIsNotKnown) {
    const skeleton::Model model = make_lattice({3, 1, 1});
    MeasurementSet set = simulate_measurements(model, push_spheres(model, {{0, 0, 1}}), markers_on_spheres(model));
    set.states[0].readings.resize(6);  // four on sphere 1, two on sphere 2
    const NodeConfiguration configuration = configuration_of_markers(model, set, set.states[0]);
    EXPECT_TRUE(configuration.known[1]);
    EXPECT_FALSE(configuration.known[2]);
    EXPECT_FALSE(configuration.complete());
    EXPECT_TRUE(measured_configurations(model, set).empty());
}

TEST(NodeConfiguration, AFieldTellsWhereItsMaterialCarriesTheSpheres) {
    // a rigid motion and a stretch about each centre: the stretch turns and moves no sphere
    const skeleton::Model model = make_lattice({3, 1, 1});
    Field field{mesh::make_bar({-20, -20, -20}, {100, 20, 20}, {12, 4, 4}), {}};
    const Mat3 R = skeleton::rotation({0, 0.3, 0.8});
    const Mat3 F = R * Vec3(1.1, 0.95, 0.95).asDiagonal();
    const Vec3 d(1, 2, 3);
    field.displacement = (field.mesh.nodes * F.transpose()).rowwise() + d.transpose();
    field.displacement -= field.mesh.nodes;
    const NodeConfiguration configuration = configuration_of_field(model, field);
    EXPECT_TRUE(configuration.complete());
    for (int i = 1; i < 3; ++i) {
        const Vec3 expected = F * model.spheres[i].center + d;
        EXPECT_LT((configuration.state.x.row(i).transpose() - expected).norm(), 1e-9);  // linear elements: rounding
        EXPECT_LT((configuration.state.R[i] - R).norm(), 1e-9);
    }
    EXPECT_EQ(Vec3(configuration.state.x.row(0)), model.spheres[0].center);  // held
}

}  // namespace
}  // namespace palpate::identify
