#include <cmath>
#include <cstring>
#include <functional>

#include "tests/mesh/formats/label_image/label_images.h"

namespace palpate::mesh::label_images {
namespace {

// What is refused of label images.

TEST_F(ReadLabels, WhatIsWrongIsSaid) {
    const Labels ball = oblique_ball();
    const std::string mha = meta_image(ball), nii = nifti(ball, false);
    EXPECT_TRUE(says(refusal("a.mha", mha.substr(0, 1000)), {"a.mha", "announces 43200 bytes"}));
    EXPECT_TRUE(says(refusal("b.mha", "Liver\n"), {"b.mha", "'Liver'", "Key = value"}));
    EXPECT_TRUE(says(refusal("c.mha", "NDims = 3\nElementDataFile = LOCAL\n"), {"'DimSize'"}));
    EXPECT_TRUE(says(refusal("d.mha",
                             "NDims = 3\nDimSize = 99999 99999 99999\nElementType = MET_UCHAR\n"
                             "ElementDataFile = LOCAL\n"),
                     {"99999 x 99999", "Crop"}));
    EXPECT_TRUE(says(refusal("e.mhd",
                             "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
                             "ElementDataFile = ../secret.raw\n"),
                     {"../secret.raw", "beside"}));
    Labels flat = ball;
    flat.axes.col(2) = flat.axes.col(1);
    EXPECT_TRUE(says(refusal("f.mha", meta_image(flat)), {"voxels of", "nearly in one plane"}));
    EXPECT_TRUE(says(refusal("a.nii", nii.substr(0, 300)), {"a.nii", "announces 348 bytes"}));
    EXPECT_TRUE(says(refusal("b.nii", std::string(400, 'x')), {"no NIfTI file"}));
    EXPECT_TRUE(says(refusal("c.nii.gz", gzipped(nii).substr(0, 200)), {"c.nii.gz", "unpacks"}));
    EXPECT_TRUE(says(refusal("a.nrrd", "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 1 2 2 2\nencoding: raw\n\n"),
                     {"dimension '4'"}));
    EXPECT_TRUE(
        says(refusal("b.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: bzip2\n\n"), {"'bzip2'"}));
    Labels none;
    EXPECT_TRUE(says(refusal("e.mha", meta_image(none)), {"labels nothing"}));
}

TEST_F(ReadLabels, FramesThatNoScannerHasAreRefused) {
    const Labels ball = oblique_ball();
    const auto refused = [&](const Mat3& axes) {
        Labels other = ball;
        other.axes = axes;
        return refusal("a.nii", nifti_2(other, false));
    };
    EXPECT_TRUE(says(refused(1e30 * ball.axes), {"a.nii", "1e-06 to 10000 mm", "Mend the head"}));
    EXPECT_TRUE(says(refused(1e-9 * ball.axes), {"1e-06 to 10000 mm"}));
    EXPECT_TRUE(says(refused(ball.axes * Vec3(1, 1, 500).asDiagonal()), {"up to 100 times the shortest"}));
    Mat3 sheared = Mat3::Identity();
    sheared(0, 1) = 50;
    sheared(1, 1) = 2;
    EXPECT_TRUE(says(refused(sheared), {"nearly in one plane", "right angles"}));
    Labels far = ball;
    far.origin = Vec3(0, 1e12, 0);
    EXPECT_TRUE(says(refusal("b.nii", nifti_2(far, false)), {"away from the origin"}));
}

TEST_F(ReadLabels, WhatIsNoBodyIsRefused) {
    const auto refused = [&](const std::function<bool(const Vec3&)>& is_inside) {
        Labels labels;
        labels.fill(1, is_inside);
        return refusal("a.mha", meta_image(labels));
    };
    const auto is_odd = [](const Vec3& p) { return std::lround(p.sum()) % 2 == 1; };
    const auto is_box = [](const Vec3& p, const Vec3& size) {
        return (p.array() > 3.5).all() && (p.array() < 3.5 + size.array()).all();
    };
    EXPECT_TRUE(says(refused(is_odd), {"Label 1", "no body", "Segment it anew"}));
    EXPECT_TRUE(says(refused([&](const Vec3& p) { return is_box(p, {1, 1, 1}); }), {"no body", "4 are needed"}));
    EXPECT_TRUE(says(refused([&](const Vec3& p) { return is_box(p, {30, 1, 1}); }), {"no body"}));
    EXPECT_TRUE(says(refused([](const Vec3& p) { return (p - Vec3(5, 5, 5)).norm() < 0.1 || p == Vec3(20, 9, 9); }),
                     {"no body"}));
    // Two voxels across are a body.
    EXPECT_EQ(refused([&](const Vec3& p) { return is_box(p, {30, 2, 2}); }), "");
}

TEST_F(ReadLabels, GreyValuesAreRefused) {
    std::string grey = nifti(Labels{}, false);
    const float slope = 0.5F;
    std::memcpy(grey.data() + 112, &slope, sizeof slope);
    grey[352 + 2 * 10] = 1;
    EXPECT_TRUE(says(refusal("a.nii", grey), {"voxel 10", "0.5", "grey values", "Segment"}));
}

}  // namespace
}  // namespace palpate::mesh::label_images
