#include "mesh/formats/label_image/label_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/geometry/surface_tree.h"
#include "mesh/topology/check_surface.h"
#include "tests/mesh/formats/label_image/label_images.h"

// Organs as label images: volume, place and direction of what is labelled.

namespace palpate::mesh::label_images {
namespace {

/// The ball that the label is, within what voxels can tell.
void expect_ball(const std::filesystem::path& file, const Vec3& at) {
    const BodyFile body = read_body(file);
    EXPECT_TRUE(body.is_in_mm);
    EXPECT_TRUE(check_surface(body.surface).sound()) << file;
    const double volume = 4.0 / 3 * std::numbers::pi * std::pow(ball_radius, 3);
    // counting voxels of 1.2 mm^3 tells the volume of this ball to half a per cent
    EXPECT_NEAR(signed_volume(body.surface), volume, 0.01 * volume) << file;
    double furthest = 0;
    for (const auto& vertex : body.surface.vertices.rowwise())
        furthest = std::max(furthest, std::abs((vertex.transpose() - at).norm() - ball_radius));
    EXPECT_LT(furthest, 0.75) << file;  // half the longest side of a voxel
}

TEST_F(ReadLabels, ABallIsInItsPlaceInEveryFormat) {
    const Labels ball = oblique_ball();
    expect_ball(folder.write("a.mha", meta_image(ball)), ball.middle());
    expect_ball(folder.write("a.nrrd", nrrd(ball, "raw")), ball.middle());
    expect_ball(folder.write("b.nrrd", nrrd(ball, "gzip")), ball.middle());
    expect_ball(folder.write("a.nii", nifti(ball, false)), ball.middle());
    expect_ball(folder.write("b.nii.gz", gzipped(nifti(ball, true))), ball.middle());
    expect_ball(folder.write("d.nii", nifti_2(ball, false)), ball.middle());
    expect_ball(folder.write("e.nii.gz", gzipped(nifti_2(ball, true))), ball.middle());
    Labels mirrored = ball;
    mirrored.axes.col(2) = -mirrored.axes.col(2);
    mirrored.voxels.assign(mirrored.voxels.size(), '\0');
    mirrored.fill_ball(3, mirrored.middle(), ball_radius);
    expect_ball(folder.write("c.nii", nifti(mirrored, true)), mirrored.middle());
}

TEST_F(ReadLabels, MetresAreConverted) {
    const Labels ball = oblique_ball();
    const BodyFile body = read_body(folder.write("a.nii", nifti(ball, false, 1)));
    EXPECT_NEAR(bounding_box(body.surface.vertices).longest_side(), 2000 * ball_radius, 1000);  // a voxel
}

TEST_F(ReadLabels, ALimbOfThreeVoxelsDoesNotShrink) {
    Labels labels;
    labels.fill(1, [&](const Vec3& p) { return std::hypot(p.y() - 18, p.z() - 15) <= 1.5 && p.x() > 3 && p.x() < 36; });
    const BodyFile body = read_body(folder.write("a.mha", meta_image(labels)));
    const auto voxels = static_cast<double>(std::count(labels.voxels.begin(), labels.voxels.end(), 1));
    EXPECT_NEAR(signed_volume(body.surface), voxels, 1e-4 * voxels);  // smoothing keeps the volume
    // its length too: the ends are rounded by no more than a tenth of a voxel each
    EXPECT_NEAR(bounding_box(body.surface.vertices).extent().x(), 32, 0.2);
}

TEST_F(ReadLabels, AChosenLabelIsReadAndSeveralAreListed) {
    Labels labels;
    labels.fill_ball(1, {10, 18, 15}, 6);
    labels.fill_ball(7, {28, 18, 15}, 8);
    const auto file = folder.write("two.mha", meta_image(labels));
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { read_body(file); }), {"2 labels", "1 (", "7 (", "mm^3", "--label"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_body(file, {.label = 4}); }), {"no label 4", "7 ("}));
    const BodyFile body = read_body(file, {.label = 7});
    EXPECT_NEAR(bounding_box(body.surface.vertices).extent().y(), 16, 0.5);  // half a voxel
}

TEST_F(ReadLabels, PartsAreSurfacesWithinAllThatIsLabelled) {
    Labels labels;
    labels.fill_ball(3, {20, 18, 15}, ball_radius);
    labels.fill_ball(9, {22, 18, 15}, 6);
    labels.fill_ball(1, {10, 14, 15}, 3);
    const auto file = folder.write("three.mha", meta_image(labels));
    const BodyFile body = read_body(file, {.label = {}, .parts = {9, 1}});
    const auto voxels = [&](auto... of) {
        return static_cast<double>((std::count(labels.voxels.begin(), labels.voxels.end(), of) + ...));
    };
    ASSERT_EQ(body.parts.size(), 2U);
    constexpr double close = 1e-4;  // smoothing keeps the volume
    EXPECT_NEAR(signed_volume(body.surface), voxels(1, 3, 9), close * voxels(1, 3, 9));
    EXPECT_NEAR(signed_volume(body.parts[0]), voxels(9), close * voxels(9));
    EXPECT_NEAR(signed_volume(body.parts[1]), voxels(1), close * voxels(1));
    EXPECT_TRUE(check_surface(body.parts[0]).sound());
    EXPECT_TRUE(says(body.notes.front(), {"all labels", "its volume"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_body(file, {.label = {}, .parts = {4}}); }),
                     {"three.mha", "no label 4", "9 ("}));
}

TEST_F(ReadLabels, SpecksAreLeftOutAndACutBodyIsTold) {
    Labels labels;
    labels.fill_ball(1, {20, 18, 2}, 10);  // through the border
    labels.fill_ball(1, {4, 4, 25}, 1);
    const BodyFile body = read_body(folder.write("a.mha", meta_image(labels)));
    ASSERT_EQ(body.notes.size(), 3u);
    EXPECT_TRUE(says(body.notes[0], {"border of the image"}));
    EXPECT_TRUE(says(body.notes[1], {"1 specks"}));
    EXPECT_EQ(check_surface(body.surface).components, 1);
    EXPECT_TRUE(check_surface(body.surface).closed);
}

TEST_F(ReadLabels, LargeImagesAreAveraged) {
    Labels labels;
    labels.size = {400, 20, 20};
    labels.voxels.assign(400 * 20 * 20, '\0');
    labels.fill(1, [](const Vec3& p) { return p.x() > 9 && p.x() < 390 && std::hypot(p.y() - 10, p.z() - 10) < 7; });
    const BodyFile body = read_body(folder.write("a.mha", meta_image(labels)));
    const auto voxels = static_cast<double>(std::count(labels.voxels.begin(), labels.voxels.end(), 1));
    EXPECT_NEAR(signed_volume(body.surface), voxels, 1e-4 * voxels);   // smoothing keeps the volume
    EXPECT_NEAR(bounding_box(body.surface.vertices).min.x(), 9.5, 1);  // cells of three voxels
}

}  // namespace
}  // namespace palpate::mesh::label_images
