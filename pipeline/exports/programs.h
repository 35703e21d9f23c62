#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A scene for SOFA with SofaPython3 (a .py): the spheres as rigid frames, the links' law in numpy as a force field on
/// them, what holds the body, and the skin. Its law also stands alone, without SOFA: forces(x, q). Units: mm, N, tonne,
/// s. Returns what the scene leaves out, in words.
std::vector<std::string> write_sofa(const std::filesystem::path& file, const skeleton::Model& model);

/// C++ for CHAI3D's GEL module (a header): a function that makes the skeleton of nodes and links, and its skin. Units:
/// m, N, kg, s. Returns what GEL does not have, in words.
std::vector<std::string> write_chai3d(const std::filesystem::path& file, const skeleton::Model& model);

}  // namespace palpate::pipeline
