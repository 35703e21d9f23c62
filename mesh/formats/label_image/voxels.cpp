#include "mesh/formats/label_image/voxels.h"

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

constexpr double most_voxels = 1e9;
constexpr std::size_t most_labels = 1000;

template <class T>
T stored(const char* at, bool is_swapped) {
    std::array<char, sizeof(T)> bytes;
    std::copy_n(at, sizeof(T), bytes.begin());
    if (is_swapped) std::ranges::reverse(bytes);
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

/// From an electron microscope's voxel to one of a survey: what any instrument images lies between.
constexpr double least_spacing = 1e-6, largest_spacing = 1e4;  // [mm]
constexpr double slenderest_voxel = 100;                       // longest side through shortest
constexpr double flattest_voxel = 0.1;                         // volume through that of a box with its sides

void require_voxels_with_shape(const LabelImage& image, const std::filesystem::path& file) {
    const Vec3 sides = image.axes.colwise().norm();
    const auto refuse = [&](const std::string& what) {
        throw InvalidInput(
            fmt::format("{}: its spacing and directions make voxels of {:.3g} x {:.3g} x {:.3g} mm, {}. Mend the head.",
                        file.string(), sides.x(), sides.y(), sides.z(), what));
    };
    if (!(sides.minCoeff() >= least_spacing && sides.maxCoeff() <= largest_spacing))
        refuse(fmt::format("{:g} to {:g} mm is allowed along each axis", least_spacing, largest_spacing));
    if (sides.maxCoeff() > slenderest_voxel * sides.minCoeff())
        refuse(fmt::format("the longest side up to {:g} times the shortest is allowed", slenderest_voxel));
    if (!(image.voxel_volume() >= flattest_voxel * sides.prod()))
        refuse(
            fmt::format("whose sides lie nearly in one plane: {:.2g} of the volume that they would have at right "
                        "angles, {:g} and more is allowed",
                        image.voxel_volume() / sides.prod(), flattest_voxel));
    if (!(image.origin.cwiseAbs().maxCoeff() <= 1e6 * sides.maxCoeff()))
        refuse(fmt::format("{:.3g} mm away from the origin, up to a million voxels is allowed",
                           image.origin.cwiseAbs().maxCoeff()));
}

}  // namespace

double LabelImage::value(std::int64_t voxel) const {
    const char* at = voxels.data() + voxel * type.bytes;
    const auto as = [&]<class T>(T) { return slope * static_cast<double>(stored<T>(at, type.is_swapped)) + intercept; };
    using Kind = VoxelType::Kind;
    if (type.kind == Kind::Float) return type.bytes == 4 ? as(float{}) : as(double{});
    const bool is_signed = type.kind == Kind::Signed;
    switch (type.bytes) {
        case 1:
            return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
        case 2:
            return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
        case 4:
            return is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
        default:
            return is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
    }
}

double LabelImage::voxel_volume() const { return std::abs(axes.determinant()); }

std::size_t checked_bytes(const LabelImage& image, const std::filesystem::path& file) {
    double voxels = 1;
    for (const std::int64_t along : image.size) {
        if (along < 1)
            throw InvalidInput(fmt::format("{}: an image of {} x {} x {} voxels; each axis needs one. Export it again.",
                                           file.string(), image.size[0], image.size[1], image.size[2]));
        voxels *= static_cast<double>(along);
    }
    if (voxels > most_voxels)
        throw InvalidInput(
            fmt::format("{}: an image of {} x {} x {} voxels; up to {:g} in all are allowed. Crop it round "
                        "the organ, or resample it.",
                        file.string(), image.size[0], image.size[1], image.size[2], most_voxels));
    require_voxels_with_shape(image, file);
    return static_cast<std::size_t>(image.count()) * static_cast<std::size_t>(image.type.bytes);
}

std::string inflated(std::string_view compressed, std::size_t needed, const std::filesystem::path& file) {
    z_stream stream{};
    if (inflateInit2(&stream, 15 + 32) != Z_OK)  // gzip and zlib heads are told apart
        throw InvalidInput(fmt::format("{}: cannot be unpacked, zlib does not start.", file.string()));
    std::string bytes;
    std::size_t taken = 0;
    int state = Z_OK;
    std::array<char, 1 << 16> piece;
    while (bytes.size() < needed && (state == Z_OK || state == Z_BUF_ERROR)) {
        if (stream.avail_in == 0) {
            const std::size_t next = std::min<std::size_t>(compressed.size() - taken, 1 << 20);
            if (next == 0) break;
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data() + taken));
            stream.avail_in = static_cast<uInt>(next);
            taken += next;
        }
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        state = inflate(&stream, Z_NO_FLUSH);
        bytes.append(piece.data(), piece.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (bytes.size() < needed)
        throw InvalidInput(
            fmt::format("{}: unpacks to {} bytes, but the image takes {}. It is cut off or damaged: export "
                        "or copy it again.",
                        file.string(), bytes.size(), needed));
    bytes.resize(needed);
    return bytes;
}

std::string as_stored(std::string_view bytes, std::size_t needed, const std::filesystem::path& file) {
    if (bytes.size() < needed)
        throw InvalidInput(fmt::format(
            "{}: its head announces {} bytes of voxels, but {} follow. It is cut off: export or copy it again.",
            file.string(), needed, bytes.size()));
    return std::string(bytes.substr(0, needed));
}

std::filesystem::path beside(const std::filesystem::path& head, const std::string& name) {
    if (name.empty() || name.find_first_of("/\\") != std::string::npos || name == "." || name == "..")
        throw InvalidInput(
            fmt::format("{}: its voxels stand in {}; a file beside it is allowed.", head.string(), cited(name)));
    return head.parent_path() / name;
}

std::vector<double> numbers_in(std::string_view text, std::size_t count, const std::string& what,
                               const std::filesystem::path& file) {
    std::vector<double> numbers;
    constexpr std::string_view between = " \t\r,()[]";
    std::size_t at = 0;
    while ((at = text.find_first_not_of(between, at)) != std::string_view::npos) {
        const std::size_t end = std::min(text.find_first_of(between, at), text.size());
        if (const auto number = parse_number(text.substr(at, end - at))) numbers.push_back(*number);
        at = end;
    }
    if (numbers.size() != count)
        throw InvalidInput(fmt::format("{}: {} is {}; {} numbers are allowed. Mend the head.", file.string(), what,
                                       cited(text), count));
    return numbers;
}

std::map<int, std::int64_t> labels_of(const LabelImage& image, const std::filesystem::path& file) {
    std::map<int, std::int64_t> labels;
    const auto refuse = [&](const std::string& what) {
        throw InvalidInput(
            fmt::format("{}: {}, it is an image of grey values, not of labels. Segment the organ first (3D Slicer, "
                        "ITK-SNAP), and give the label map.",
                        file.string(), what));
    };
    for (std::int64_t v = 0; v < image.count(); ++v) {
        const double value = image.value(v);
        if (value == 0) continue;
        if (!(std::abs(value) < 1e9) || value != std::round(value))
            refuse(fmt::format("voxel {} has the value {}", v, value));
        ++labels[static_cast<int>(value)];
        if (labels.size() > most_labels) refuse(fmt::format("it has more than {} different values", most_labels));
    }
    return labels;
}

int choose_label(const std::map<int, std::int64_t>& labels, std::optional<int> asked, const LabelImage& image,
                 const std::filesystem::path& file) {
    if (labels.empty()) throw InvalidInput(fmt::format("{}: all its voxels are 0, it labels nothing.", file.string()));
    if (asked && labels.contains(*asked)) return *asked;
    if (!asked && labels.size() == 1) return labels.begin()->first;
    std::string list;
    for (const auto& [label, voxels] : labels)
        list += fmt::format("{}{} ({:.4g} mm^3)", list.empty() ? "" : ", ", label,
                            static_cast<double>(voxels) * image.voxel_volume());
    throw InvalidInput(asked ? fmt::format("{}: has no label {}; there are {}.", file.string(), *asked, list)
                             : fmt::format("{}: holds {} labels: {}. Choose one with --label, or name them by regions: "
                                           "the body is all of them, then.",
                                           file.string(), labels.size(), list));
}

}  // namespace palpate::mesh
