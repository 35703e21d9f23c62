#pragma once

#include <filesystem>
#include <vector>

#include "skeleton/model/state.h"

namespace palpate::pipeline {

/// What a glTF file holds beside the model.
struct GltfReport {
    double skin_error = 0;  // of four influences a vertex, as a share of the displacement [-]
};

/// glTF 2.0: the skin at rest, skinned to a joint a sphere; with states an animation, a second each, from rest. Metres,
/// as glTF has them. A name that ends in .glb is written as one binary file, any other as JSON that holds its data.
/// @throws InvalidInput when the model has no skin; IoError.
GltfReport write_gltf(const std::filesystem::path& file, const skeleton::Model& model,
                      const std::vector<skeleton::State>& states);

}  // namespace palpate::pipeline
