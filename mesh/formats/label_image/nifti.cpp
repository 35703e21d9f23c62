#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "mesh/errors.h"
#include "mesh/formats/label_image/voxels.h"
#include "mesh/text/atomic_file.h"

namespace palpate::mesh {
namespace {

/// Where the fields of a head are, in bytes. [nifti1.h, nifti2.h]
struct NiftiLayout {
    std::int32_t head_bytes;  // which the head begins with, and is known by
    std::string_view magic;
    std::size_t magic_at, dimensions, type, spacing, voxels_begin, slope, intercept, unit, by_quaternion, by_rows,
        quaternion, shift, rows;
};
constexpr std::array layouts{
    NiftiLayout{348, "n+1", 344, 40, 70, 76, 108, 112, 116, 123, 252, 254, 256, 268, 280},
    NiftiLayout{540, "n+2", 4, 16, 12, 104, 168, 176, 184, 500, 344, 348, 352, 376, 400},
};
constexpr auto least_head_bytes = static_cast<std::size_t>(layouts.front().head_bytes);

/// The head of a NIfTI file, version 1 or 2: the second one has wider numbers in other places.
class NiftiHeader {
public:
    /// @throws InvalidInput when these bytes begin no NIfTI file of one piece.
    NiftiHeader(std::string bytes, const std::filesystem::path& file) : bytes_(std::move(bytes)) {
        for (const NiftiLayout& layout : layouts)
            for (const bool is_swapped : {false, true}) {
                is_swapped_ = is_swapped;
                const auto length = static_cast<std::size_t>(layout.head_bytes);
                if (bytes_.size() < length || at<std::int32_t>(0) != layout.head_bytes ||
                    bytes_.compare(layout.magic_at, layout.magic.size(), layout.magic) != 0)
                    continue;
                layout_ = &layout;
                return;
            }
        throw InvalidInput(
            fmt::format("{}: is no NIfTI file of one piece. Save it as .nii or .nii.gz.", file.string()));
    }

    const NiftiLayout& layout() const { return *layout_; }
    bool is_swapped() const { return is_swapped_; }
    int type() const { return at<std::int16_t>(layout_->type); }

    /// 0: how many; from 1 on: voxels along each.
    std::int64_t dimension(std::size_t d) const {
        return is_first() ? at<std::int16_t>(layout_->dimensions + 2 * d)
                          : at<std::int64_t>(layout_->dimensions + 8 * d);
    }
    /// The i-th of the real numbers from a place on.
    double real(std::size_t place, std::size_t i = 0) const {
        return is_first() ? at<float>(place + 4 * i) : at<double>(place + 8 * i);
    }
    int code(std::size_t place) const { return is_first() ? at<std::int16_t>(place) : at<std::int32_t>(place); }
    int unit() const { return is_first() ? at<std::uint8_t>(layout_->unit) : at<std::int32_t>(layout_->unit); }
    double voxels_begin() const {
        return is_first() ? at<float>(layout_->voxels_begin)
                          : static_cast<double>(at<std::int64_t>(layout_->voxels_begin));
    }

private:
    bool is_first() const { return layout_ == layouts.data(); }

    template <class T>
    T at(std::size_t place) const {
        std::array<char, sizeof(T)> piece;
        std::copy_n(bytes_.data() + place, sizeof(T), piece.begin());
        if (is_swapped_) std::ranges::reverse(piece);
        T value;
        std::memcpy(&value, piece.data(), sizeof value);
        return value;
    }

    std::string bytes_;
    const NiftiLayout* layout_ = nullptr;
    bool is_swapped_ = false;
};

VoxelType nifti_type(const NiftiHeader& head, const std::filesystem::path& file) {
    using Kind = VoxelType::Kind;
    const int code = head.type();
    switch (code) {
        case 2:
            return {Kind::Unsigned, 1, head.is_swapped()};
        case 4:
            return {Kind::Signed, 2, head.is_swapped()};
        case 8:
            return {Kind::Signed, 4, head.is_swapped()};
        case 16:
            return {Kind::Float, 4, head.is_swapped()};
        case 64:
            return {Kind::Float, 8, head.is_swapped()};
        case 256:
            return {Kind::Signed, 1, head.is_swapped()};
        case 512:
            return {Kind::Unsigned, 2, head.is_swapped()};
        case 768:
            return {Kind::Unsigned, 4, head.is_swapped()};
        case 1024:
            return {Kind::Signed, 8, head.is_swapped()};
        case 1280:
            return {Kind::Unsigned, 8, head.is_swapped()};
        default:
            throw InvalidInput(
                fmt::format("{}: voxels of type {}; whole or real numbers are allowed. Export labels as "
                            "16-bit numbers.",
                            file.string(), code));
    }
}

/// Where voxels are: by the affine rows (sform) where they count, else by the quaternion (qform), else by spacing
/// alone.
void place_nifti(const NiftiHeader& head, LabelImage& image) {
    const NiftiLayout& at = head.layout();
    if (head.code(at.by_rows) > 0) {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column)
                (column < 3 ? image.axes(row, column) : image.origin[row]) =
                    head.real(at.rows, static_cast<std::size_t>(4 * row + column));
        return;
    }
    const auto three = [&](std::size_t place, std::size_t first) {
        return Vec3(head.real(place, first), head.real(place, first + 1), head.real(place, first + 2));
    };
    Vec3 spacing = three(at.spacing, 1);
    if (head.code(at.by_quaternion) > 0) {
        const Vec3 axis = three(at.quaternion, 0);
        const Eigen::Quaterniond turn(std::sqrt(std::max(0.0, 1 - axis.squaredNorm())), axis.x(), axis.y(), axis.z());
        if (head.real(at.spacing) < 0) spacing.z() = -spacing.z();
        image.axes = turn.normalized().toRotationMatrix() * spacing.asDiagonal();
        image.origin = three(at.shift, 0);
        return;
    }
    image.axes = spacing.asDiagonal();
}

double unit_in_mm(const NiftiHeader& head) {
    switch (head.unit() & 7) {
        case 1:
            return 1000;
        case 3:
            return 1e-3;
        default:
            return 1;  // millimetres, also where nothing is said
    }
}

/// As many bytes as the longest head has, or all.
std::string header_of(const std::string& content, bool is_packed, const std::filesystem::path& file) {
    constexpr auto longest = static_cast<std::size_t>(layouts.back().head_bytes);
    if (!is_packed) return as_stored(content, std::clamp(content.size(), least_head_bytes, longest), file);
    std::string least = inflated(content, least_head_bytes, file);
    const NiftiLayout& second = layouts.back();
    return least.compare(second.magic_at, second.magic.size(), second.magic) == 0 ? inflated(content, longest, file)
                                                                                  : least;
}

}  // namespace

LabelImage read_nifti(const std::filesystem::path& file) {
    const std::string content = read_text(file);
    const bool is_packed = content.starts_with("\x1f\x8b");
    const NiftiHeader head(header_of(content, is_packed, file), file);

    LabelImage image;
    for (std::size_t d = 0; d < 3; ++d) image.size[d] = head.dimension(d + 1);
    const auto dimensions = static_cast<std::size_t>(std::clamp<std::int64_t>(head.dimension(0), 3, 7));
    for (std::size_t d = 4; d <= dimensions; ++d)
        if (const std::int64_t more = head.dimension(d); more > 1)
            throw InvalidInput(fmt::format(
                "{}: holds {} volumes; one is allowed. Extract the one that labels the organ.", file.string(), more));
    image.type = nifti_type(head, file);
    if (const double slope = head.real(head.layout().slope); slope != 0 && std::isfinite(slope)) {
        image.slope = slope;
        image.intercept = head.real(head.layout().intercept);
    }
    place_nifti(head, image);
    image.axes *= unit_in_mm(head);
    image.origin *= unit_in_mm(head);

    const std::size_t bytes = checked_bytes(image, file);
    const double offset = head.voxels_begin();
    if (!(offset >= 0 && offset < 1e9))
        throw InvalidInput(fmt::format("{}: its voxels begin at byte {}. Mend the head.", file.string(), offset));
    const auto begin = std::max(static_cast<std::size_t>(head.layout().head_bytes), static_cast<std::size_t>(offset));
    const std::string unpacked = is_packed ? inflated(content, begin + bytes, file) : content;
    image.voxels = as_stored(std::string_view(unpacked).substr(std::min(begin, unpacked.size())), bytes, file);
    return image;
}

}  // namespace palpate::mesh
