#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/formats/label_image/label_image.h"

namespace palpate::mesh {

/// Checks the size that an image's head announces; how many bytes its voxels take.
/// @throws InvalidInput when an axis has no voxel, or there are more than anybody can compute with.
std::size_t checked_bytes(const LabelImage& image, const std::filesystem::path& file);

/// The first `needed` bytes of what a gzip or zlib stream holds. @throws InvalidInput when it is broken or holds less.
std::string inflated(std::string_view compressed, std::size_t needed, const std::filesystem::path& file);

/// Exactly `needed` bytes, as they stand. @throws InvalidInput when there are less.
std::string as_stored(std::string_view bytes, std::size_t needed, const std::filesystem::path& file);

/// The file that holds an image's voxels beside its head. @throws InvalidInput when it is in another folder.
std::filesystem::path beside(const std::filesystem::path& head, const std::string& name);

/// Numbers in a head, parted by blanks, commas or brackets. @throws InvalidInput unless there are `count`.
std::vector<double> numbers_in(std::string_view text, std::size_t count, const std::string& what,
                               const std::filesystem::path& file);

}  // namespace palpate::mesh
