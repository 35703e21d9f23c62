#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "mesh/read/label_image/voxels.h"

namespace palpate::mesh {
namespace {

constexpr std::size_t nifti_head_bytes = 348;

/// The head of a NIfTI-1 file. [nifti1.h: fields at these places]
class NiftiHead {
public:
    explicit NiftiHead(std::string bytes) : bytes_(std::move(bytes)) { is_swapped_ = at<std::int32_t>(0) != 348; }

    template <class T>
    T at(std::size_t place) const {
        std::array<char, sizeof(T)> piece;
        std::copy_n(bytes_.data() + place, sizeof(T), piece.begin());
        if (is_swapped_) std::ranges::reverse(piece);
        T value;
        std::memcpy(&value, piece.data(), sizeof value);
        return value;
    }
    bool is_nifti() const { return at<std::int32_t>(0) == 348 && std::memcmp(bytes_.data() + 344, "n+1", 4) == 0; }
    bool is_swapped() const { return is_swapped_; }

private:
    std::string bytes_;
    bool is_swapped_ = false;
};

VoxelType nifti_type(const NiftiHead& head, const std::filesystem::path& file) {
    using Kind = VoxelType::Kind;
    const int code = head.at<std::int16_t>(70);
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
void place_nifti(const NiftiHead& head, LabelImage& image) {
    if (head.at<std::int16_t>(254) > 0) {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) {
                const auto value =
                    head.at<float>(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(column));
                (column < 3 ? image.axes(row, column) : image.origin[row]) = value;
            }
        return;
    }
    Vec3 spacing(head.at<float>(80), head.at<float>(84), head.at<float>(88));
    if (head.at<std::int16_t>(252) > 0) {
        const double b = head.at<float>(256), c = head.at<float>(260), d = head.at<float>(264);
        const Eigen::Quaterniond turn(std::sqrt(std::max(0.0, 1 - b * b - c * c - d * d)), b, c, d);
        if (head.at<float>(76) < 0) spacing.z() = -spacing.z();
        image.axes = turn.normalized().toRotationMatrix() * spacing.asDiagonal();
        image.origin = Vec3(head.at<float>(268), head.at<float>(272), head.at<float>(276));
        return;
    }
    image.axes = spacing.asDiagonal();
}

double unit_in_mm(const NiftiHead& head) {
    switch (head.at<std::uint8_t>(123) & 7) {
        case 1:
            return 1000;
        case 3:
            return 1e-3;
        default:
            return 1;  // millimetres, also where nothing is said
    }
}

}  // namespace

LabelImage read_nifti(const std::filesystem::path& file) {
    const std::string content = read_text(file);
    const bool is_packed = content.starts_with("\x1f\x8b");
    const NiftiHead head(is_packed ? inflated(content, nifti_head_bytes, file)
                                   : as_stored(content, nifti_head_bytes, file));
    if (!head.is_nifti())
        throw InvalidInput(
            fmt::format("{}: is no NIfTI-1 file of one piece. Save it as .nii or .nii.gz, version 1.", file.string()));

    LabelImage image;
    for (std::size_t d = 0; d < 3; ++d) image.size[d] = head.at<std::int16_t>(42 + 2 * d);
    for (std::size_t d = 3; d < static_cast<std::size_t>(std::clamp<int>(head.at<std::int16_t>(40), 3, 7)); ++d)
        if (const int more = head.at<std::int16_t>(42 + 2 * d); more > 1)
            throw InvalidInput(fmt::format(
                "{}: holds {} volumes; one is allowed. Extract the one that labels the organ.", file.string(), more));
    image.type = nifti_type(head, file);
    if (const double slope = head.at<float>(112); slope != 0 && std::isfinite(slope)) {
        image.slope = slope;
        image.intercept = head.at<float>(116);
    }
    place_nifti(head, image);
    image.axes *= unit_in_mm(head);
    image.origin *= unit_in_mm(head);

    const std::size_t bytes = checked_bytes(image, file);
    const double offset = head.at<float>(108);
    if (!(offset >= 0 && offset < 1e9))
        throw InvalidInput(fmt::format("{}: its voxels begin at byte {}. Mend the head.", file.string(), offset));
    const auto begin = std::max(nifti_head_bytes, static_cast<std::size_t>(offset));
    const std::string unpacked = is_packed ? inflated(content, begin + bytes, file) : content;
    image.voxels = as_stored(std::string_view(unpacked).substr(std::min(begin, unpacked.size())), bytes, file);
    return image;
}

}  // namespace palpate::mesh
