#include "label_images.h"

#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>

namespace palpate::mesh::label_images {

namespace {

std::string row(const Vec3& v, const char* between = " ") {
    return std::to_string(v.x()) + between + std::to_string(v.y()) + between + std::to_string(v.z());
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

}  // namespace

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

std::string meta_image(const Labels& labels, const std::string& more) {
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

std::string nifti(const Labels& labels, bool as_quaternion, std::uint8_t unit) {
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

}  // namespace palpate::mesh::label_images
