#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh/types.h"

namespace palpate::mesh {

/// How a voxel is stored.
struct VoxelType {
    enum class Kind { Signed, Unsigned, Float };
    Kind kind = Kind::Unsigned;
    int bytes = 1;
    bool is_swapped = false;  // other order of bytes than this machine's
};

/// Voxels on a grid; which organ each belongs to is told by its value.
struct LabelImage {
    std::array<std::int64_t, 3> size{};  // voxels along each axis, the first one runs fastest
    Mat3 axes = Mat3::Identity();        // from a voxel's centre to the next one along each axis, a column each [mm]
    Vec3 origin = Vec3::Zero();          // centre of the first voxel [mm]
    VoxelType type;
    double slope = 1, intercept = 0;  // value = slope stored + intercept
    std::string voxels;

    std::int64_t count() const { return size[0] * size[1] * size[2]; }
    double value(std::int64_t voxel) const;
    double voxel_volume() const;  // [mm^3]
};

/// One reader a format: NIfTI-1 and -2 (.nii, .nii.gz), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd). Placing, spacing
/// and direction are the file's; coordinates are the format's own (NIfTI: right, anterior, superior; the others: left,
/// posterior, superior). @throws IoError, InvalidInput with what is wrong in the head, or missing behind it.
LabelImage read_nifti(const std::filesystem::path& file);
LabelImage read_nrrd(const std::filesystem::path& file);
LabelImage read_meta_image(const std::filesystem::path& file);

/// The labels of an image, with how many voxels each has; 0 is no label.
/// @throws InvalidInput when its values are no labels: not whole, or more than 1000 different ones.
std::map<int, std::int64_t> labels_of(const LabelImage& image, const std::filesystem::path& file);

/// The label asked for, else the only one. @throws InvalidInput listing those that there are.
int choose_label(const std::map<int, std::int64_t>& labels, std::optional<int> asked, const LabelImage& image,
                 const std::filesystem::path& file);

}  // namespace palpate::mesh
