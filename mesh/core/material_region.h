#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// A part of a body that is of a material of its own, bonded to what is around it: what a closed surface within the
/// body encloses, less the regions within it.
struct MaterialRegion {
    std::string name;
    Surface surface{};                // closed, outward [mm]
    std::optional<double> young{};    // [MPa]; none: unknown, to be identified
    std::optional<double> poisson{};  // none: the body's
    std::optional<double> density{};  // [tonne/mm^3]; none: the body's
    std::optional<int> label{};       // that the body's file gives it, where the surface comes from there
    std::filesystem::path file{};     // that the surface comes from otherwise
};

}  // namespace palpate::mesh
