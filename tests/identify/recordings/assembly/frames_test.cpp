// The frame of a recording on that of the mesh.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "identify/numerics/random.h"
#include "identify/recordings/assembly/frames/surface_fit.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

// Rounding of a turn, and of places some 1000 mm from the camera.
constexpr double turn_rounding = 1e-14, mm_rounding = 3e-12;

const RigidMotion hidden{Eigen::AngleAxisd(2.3, Vec3(1, -2, 0.5).normalized()).toRotationMatrix(), Vec3(300, -40, 900),
                         1};

/// What a camera sees of points of the mesh.
Points recorded(const Points& on_mesh, double noise = 0, std::uint64_t key = 1) {
    Points seen = (on_mesh.rowwise() - hidden.t.transpose()) * hidden.R;
    RandomStream random(11, key, 0);
    for (double& x : seen.reshaped()) x += noise * random.normal();
    return seen;
}

Points fiducials() {
    Points points(5, 3);
    points << 0, 0, 0, 100, 0, 0, 0, 60, 0, 0, 0, 30, 80, 50, 20;
    return points;
}

double angle_between(const Mat3& a, const Mat3& b) { return Eigen::AngleAxisd(a * b.transpose()).angle(); }

TEST(Frames, AreFoundFromNamedPointsExactly) {
    const Registration fit = fit_counterparts(recorded(fiducials()), fiducials());
    EXPECT_NEAR(angle_between(fit.motion.R, hidden.R), 0, turn_rounding);
    EXPECT_LT((fit.motion.t - hidden.t).norm(), mm_rounding);
    EXPECT_LT(fit.rms, mm_rounding);
    EXPECT_TRUE(fit.notes.empty());
}

TEST(Frames, KnowHowWellTheyAreKnown) {
    // over 300 draws of noise the true error is what the Hessian tells
    double turns = 0, told_turns = 0, shifts = 0, told_shifts = 0;
    const Eigen::RowVector3d centre = fiducials().colwise().mean();
    for (std::uint64_t key = 1; key <= 300; ++key) {
        const Registration fit = fit_counterparts(recorded(fiducials(), 0.5, key), fiducials());
        const Vec3 off = fit.motion(Vec3(hidden.R.transpose() * (centre.transpose() - hidden.t))) - centre.transpose();
        turns += std::pow(angle_between(fit.motion.R, hidden.R), 2);
        told_turns += fit.rotation_sd * fit.rotation_sd;
        shifts += off.squaredNorm() / 3;
        told_shifts += fit.translation_sd * fit.translation_sd;
    }
    EXPECT_NEAR(told_shifts / shifts, 1, 0.2);  // 4 sd of 900 squares
    // of three axes the worst is told, which has 0.56 of all; 4 sd of 600 squares
    EXPECT_NEAR(told_turns / turns, 0.56, 0.13);
}

TEST(Frames, OfAnotherScaleAreFoundWhereThatIsAsked) {
    const Registration fit = fit_counterparts(1.25 * recorded(fiducials()), fiducials(), true);
    EXPECT_NEAR(fit.motion.scale, 0.8, 1e-14);  // rounding
    EXPECT_LT(fit.rms, mm_rounding);
}

TEST(Frames, ThatAreMirroredAreTold) {
    Points mirrored = recorded(fiducials(), 0.1);
    mirrored.col(1) *= -1;
    // noise of 0.1 mm next to levers of some 30 mm: 0.003, in a few numbers known to a factor of two
    EXPECT_LT(mirrored_share(mirrored, fiducials()), 0.006);
    EXPECT_GT(mirrored_share(recorded(fiducials(), 0.1), fiducials()), 1 / 0.006);
    EXPECT_EQ(mirrored_share(recorded(fiducials().topRows(3)), fiducials().topRows(3)), 1) << "a plane has no hand";
}

TEST(Frames, OfPointsOnALineLeaveATurnOpenAndSayIt) {
    Points line(3, 3);
    line << 0, 0, 0, 10, 0, 0, 40, 0, 0;
    const Registration fit = fit_counterparts(recorded(line), line);
    EXPECT_LT(fit.rms, mm_rounding);
    ASSERT_EQ(fit.notes.size(), 1U);
    EXPECT_TRUE(says(fit.notes[0], {"on a line", "not determined"}));
    EXPECT_TRUE(says(message_of([&] { fit_counterparts(line.topRows(1), line.topRows(1)); }), {"1 point", "three"}));
}

TEST(Frames, InAPlaneTurnAboutItsNormal) {
    Points flat = fiducials().topRows(3);
    Points seen = flat;
    const Mat3 R = Eigen::AngleAxisd(0.4, Vec3::UnitZ()).toRotationMatrix();
    seen = ((flat.rowwise() - Eigen::RowVector3d(3, 4, 0)) * R).eval();
    const Registration fit = fit_counterparts_in_plane(seen, flat);
    EXPECT_NEAR(angle_between(fit.motion.R, R), 0, turn_rounding);
    EXPECT_LT(fit.rms, mm_rounding);
    EXPECT_TRUE(
        says(message_of([&] { fit_counterparts_in_plane(seen.topRows(1), flat.topRows(1)); }), {"1 point", "two"}));
}

TEST(Frames, OfKnownTurnTakeOnePoint) {
    const Registration fit = fit_shift(recorded(fiducials().topRows(1)), fiducials().topRows(1), hidden.R);
    EXPECT_LT((fit.motion.t - hidden.t).norm(), mm_rounding);
    EXPECT_TRUE(says(message_of([&] { fit_shift(Points(0, 3), Points(0, 3), hidden.R); }), {"No point was seen"}));
}

TEST(Units, ThatSlippedAreRecognised) {
    EXPECT_TRUE(says(slip_of_units(1000), {"mm and m"}));
    EXPECT_TRUE(says(slip_of_units(1 / 25.6), {"mm and inch"}));
    EXPECT_TRUE(says(slip_of_units(0.098), {"mm and cm"}));
    EXPECT_EQ(slip_of_units(1.2), "");
    EXPECT_EQ(slip_of_units(3), "");
}

/// A box with a step: no turn takes it into itself.
mesh::Surface stepped_box() {
    mesh::Surface box = mesh::make_box({0, 0, 0}, {100, 60, 30}, {20, 12, 6});
    for (auto vertex : box.vertices.rowwise())
        if (vertex.x() > 60 && vertex.z() > 29)
            vertex.z() += 0.4 * (vertex.x() - 60) + 0.005 * vertex.y() * (vertex.x() - 60);
    return box;
}

/// Every so many of the vertices.
Points some_vertices(const mesh::Surface& surface, int step) {
    std::vector<int> rows;
    for (int v = 0; v < surface.vertices.rows(); v += step) rows.push_back(v);
    return surface.vertices(rows, Eigen::all);
}

TEST(SurfaceFits, OfPointsWithoutNamesFindTheFrame) {
    const mesh::Surface body = stepped_box();
    const Points points = some_vertices(body, 23);
    ASSERT_GT(points.rows(), 30);
    const Registration fit = fit_surface(recorded(points, 0.2), body);
    const Points off = fit.motion(recorded(points)) - points;
    EXPECT_LT(off.rowwise().norm().maxCoeff(), 0.5) << "of noise 0.2, by forty points";
    // six numbers are fitted; 2 sd of the others
    const auto n = static_cast<double>(points.rows());
    EXPECT_NEAR(fit.rms, 0.2 * std::sqrt(1 - 6 / n), 2 * 0.2 / std::sqrt(2 * n));
    EXPECT_TRUE(fit.notes.empty()) << fit.notes.front();
    EXPECT_GT(fit.rotation_sd, 0);
}

TEST(SurfaceFits, OfABoxSayThatTheyHaveAChoice) {
    const mesh::Surface box = mesh::make_box({0, 0, 0}, {100, 60, 30}, {10, 6, 3});
    const Registration fit = fit_surface(recorded(some_vertices(box, 5), 0.1), box);
    EXPECT_LT(fit.rms, 0.12);  // of noise 0.1
    ASSERT_FALSE(fit.notes.empty());
    EXPECT_TRUE(says(fit.notes[0], {"Another pose fits as well", "180 degrees", "symmetric"}));
}

TEST(SurfaceFits, OfPointsOnOneFaceLeaveOpenWhatMovesItIntoItself) {
    const mesh::Surface box = mesh::make_box({0, 0, 0}, {100, 60, 30}, {10, 6, 3});
    Points face(9, 3);
    for (int i = 0; i < 9; ++i) face.row(i) << 30 + 15 * (i / 3), 20 + 8 * (i % 3), 30.2;
    const Registration fit = fit_surface(face, box, {.near_only = true});
    EXPECT_NEAR(fit.motion.t.z(), -0.2, 1e-12);  // a plane is met in one step: rounding
    std::string notes;
    for (const std::string& note : fit.notes) notes += note;
    EXPECT_TRUE(says(notes, {"does not determine the turn about", "does not determine the shift along"}));
}

TEST(SurfaceFits, OfMirroredPointsSayIt) {
    const mesh::Surface body = stepped_box();
    Points mirrored = recorded(some_vertices(body, 23), 0.05);
    mirrored.col(2) *= -1;
    std::string notes;
    for (const std::string& note : fit_surface(mirrored, body).notes) notes += note;
    EXPECT_TRUE(says(notes, {"mirrored points fit", "left-handed"}));
}

TEST(SurfaceFits, KeepTheHeightOfMarkersThatStandOff) {
    const mesh::Surface body = stepped_box();
    const Points normals = mesh::vertex_normals(body);
    std::vector<int> rows;
    for (int v = 0; v < body.vertices.rows(); v += 23) rows.push_back(v);
    // vertices amid faces: on an edge a normal points between two
    std::erase_if(rows, [&](int v) { return normals.row(v).cwiseAbs().maxCoeff() < 0.999; });
    const Points standing = body.vertices(rows, Eigen::all) + 4 * normals(rows, Eigen::all);
    const Registration fit = fit_surface(recorded(standing), body, {.stand_off = 4});
    EXPECT_LT((fit.motion(recorded(standing)) - standing).rowwise().norm().maxCoeff(), mm_rounding);  // without noise
}

TEST(SurfaceFits, TakeSixPoints) {
    const mesh::Surface body = stepped_box();
    EXPECT_TRUE(says(message_of([&] { fit_surface(Points::Zero(5, 3), body); }), {"5 points without names", "six"}));
}

}  // namespace
}  // namespace palpate::identify
