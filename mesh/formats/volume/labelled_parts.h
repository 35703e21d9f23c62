#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// Surfaces of the elements of each label, closed and outward: their sides that no other element of the label has,
/// with midsides where the elements have them. `labels`: one an element, or none at all.
/// @throws InvalidInput naming the file where it tells no labels, or not one of those asked for.
std::vector<Surface> labelled_parts(const VolumeMesh& mesh, const std::vector<std::int64_t>& labels,
                                    const std::vector<int>& asked, const std::filesystem::path& file);

}  // namespace palpate::mesh
