// Organs as label images: volume, place and direction of what is labelled, and what is refused.

#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numbers>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/topology/check_surface.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

constexpr double ball_radius = 12;  // [mm]

/// A label image in memory: voxels by their centres, through axes and origin.
struct Labels {
    std::array<int, 3> size{40, 36, 30};
    Mat3 axes = Mat3::Identity();
    Vec3 origin = Vec3::Zero();
    std::string voxels = std::string(static_cast<std::size_t>(40) * 36 * 30, '\0');

    Vec3 center(int x, int y, int z) const { return axes * Vec3(x, y, z) + origin; }
    Vec3 middle() const { return axes * Vec3(size[0] - 1, size[1] - 1, size[2] - 1) / 2 + origin; }

    template <class Is>
    void fill(char label, const Is& is_inside) {
        std::size_t v = 0;
        for (int z = 0; z < size[2]; ++z)
            for (int y = 0; y < size[1]; ++y)
                for (int x = 0; x < size[0]; ++x, ++v)
                    if (is_inside(center(x, y, z))) voxels[v] = label;
    }
    void fill_ball(char label, const Vec3& at, double radius) {
        fill(label, [&](const Vec3& p) { return (p - at).norm() <= radius; });
    }
};

/// Unequal spacing, turned axes, far from the origin.
Labels oblique_ball() {
    Labels labels;
    labels.axes =
        Eigen::AngleAxisd(0.4, Vec3(1, 2, -1).normalized()).toRotationMatrix() * Vec3(0.8, 1, 1.5).asDiagonal();
    labels.origin = Vec3(100, -50, 30);
    labels.fill_ball(3, labels.middle(), ball_radius);
    return labels;
}

std::string gzipped(const std::string& bytes) {
    std::string packed(compressBound(bytes.size()) + 64, '\0');
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(packed.size() - stream.avail_out);
    deflateEnd(&stream);
    return packed;
}

std::string row(const Vec3& v, const char* between = " ") {
    return std::to_string(v.x()) + between + std::to_string(v.y()) + between + std::to_string(v.z());
}

std::string meta_image(const Labels& labels, const std::string& more = "") {
    const Vec3 spacing = labels.axes.colwise().norm();
    std::string text = "ObjectType = Image\nNDims = 3\n" + more + "TransformMatrix =";
    for (int d = 0; d < 3; ++d) text += " " + row(labels.axes.col(d) / spacing[d]);
    return text + "\nOffset = " + row(labels.origin) + "\nElementSpacing = " + row(spacing) +
           "\nDimSize = " + std::to_string(labels.size[0]) + " " + std::to_string(labels.size[1]) + " " +
           std::to_string(labels.size[2]) + "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + labels.voxels;
}

std::string nrrd(const Labels& labels, const std::string& encoding) {
    std::string text = "NRRD0004\n# by hand\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " +
                       std::to_string(labels.size[0]) + " " + std::to_string(labels.size[1]) + " " +
                       std::to_string(labels.size[2]) + "\nspace directions:";
    for (int d = 0; d < 3; ++d) text += " (" + row(labels.axes.col(d), ",") + ")";
    return text + "\nspace origin: (" + row(labels.origin, ",") + ")\nencoding: " + encoding + "\n\n" +
           (encoding == "gzip" ? gzipped(labels.voxels) : labels.voxels);
}

/// Puts numbers at places of a head, in the other order of bytes where asked.
class Head {
public:
    Head(std::size_t bytes, bool is_swapped) : text(bytes, '\0'), is_swapped_(is_swapped) {}
    template <class T>
    void put(std::size_t at, T value) {
        std::memcpy(text.data() + at, &value, sizeof value);
        if (is_swapped_)
            std::reverse(text.begin() + static_cast<long>(at), text.begin() + static_cast<long>(at + sizeof value));
    }
    std::string text;

private:
    bool is_swapped_;
};

/// Voxels of two bytes.
std::string voxels_of(const Labels& labels, bool is_swapped) {
    std::string voxels;
    for (const char label : labels.voxels) voxels += is_swapped ? std::string{'\0', label} : std::string{label, '\0'};
    return voxels;
}

/// Version 1; the place as affine rows, or as a quaternion (whose third axis may be turned).
std::string nifti(const Labels& labels, bool as_quaternion, std::uint8_t unit = 2) {
    Head head(352, false);
    head.put(0, std::int32_t{348});
    head.put(40, std::int16_t{3});
    for (std::size_t d = 0; d < 3; ++d) head.put(42 + 2 * d, static_cast<std::int16_t>(labels.size[d]));
    head.put(70, std::int16_t{4});
    head.put(72, std::int16_t{16});
    const Vec3 spacing = labels.axes.colwise().norm();
    for (std::size_t d = 0; d < 3; ++d) head.put(80 + 4 * d, static_cast<float>(spacing[static_cast<int>(d)]));
    head.put(108, 352.0F);
    head.put(123, unit);
    Mat3 turn = labels.axes * spacing.cwiseInverse().asDiagonal();
    if (as_quaternion) {
        const bool is_mirrored = turn.determinant() < 0;
        if (is_mirrored) turn.col(2) = -turn.col(2);
        head.put(76, is_mirrored ? -1.0F : 1.0F);
        Eigen::Quaterniond q(turn);
        if (q.w() < 0) q.coeffs() = -q.coeffs();
        head.put(252, std::int16_t{1});
        head.put(256, static_cast<float>(q.x()));
        head.put(260, static_cast<float>(q.y()));
        head.put(264, static_cast<float>(q.z()));
        for (std::size_t d = 0; d < 3; ++d)
            head.put(268 + 4 * d, static_cast<float>(labels.origin[static_cast<int>(d)]));
    } else {
        head.put(254, std::int16_t{1});
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c)
                head.put(280 + static_cast<std::size_t>(16 * r + 4 * c), static_cast<float>(labels.axes(r, c)));
            head.put(292 + static_cast<std::size_t>(16 * r), static_cast<float>(labels.origin[r]));
        }
    }
    head.text.replace(344, 3, "n+1");
    return head.text + voxels_of(labels, false);
}

/// Version 2, by affine rows. [nifti2.h]
std::string nifti_2(const Labels& labels, bool is_swapped) {
    Head head(544, is_swapped);
    head.put(0, std::int32_t{540});
    head.text.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
    head.put(12, std::int16_t{4});
    head.put(14, std::int16_t{16});
    head.put(16, std::int64_t{3});
    for (std::size_t d = 0; d < 3; ++d) head.put(24 + 8 * d, std::int64_t{labels.size[d]});
    head.put(168, std::int64_t{544});
    head.put(348, std::int32_t{1});
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) head.put(400 + static_cast<std::size_t>(32 * r + 8 * c), labels.axes(r, c));
        head.put(424 + static_cast<std::size_t>(32 * r), labels.origin[r]);
    }
    head.put(500, std::int32_t{2});
    return head.text + voxels_of(labels, is_swapped);
}

struct ReadLabels : ::testing::Test {
    std::string refusal(const std::string& name, const std::string& text) {
        return message_of<InvalidInput>([&] { read_body(folder.write(name, text)); });
    }
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
    TemporaryFolder folder;
};

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
}  // namespace palpate::mesh
