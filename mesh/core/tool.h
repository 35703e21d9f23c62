#pragma once

#include <string>
#include <variant>
#include <vector>

#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/types.h"

namespace palpate::mesh {

/// A ball about the tool's origin.
struct SphereShape {
    double radius = 0;  // [mm]
};
/// A flat round punch: a disc about the tool's origin, which presses along `axis`.
struct FlatShape {
    double radius = 0;           // [mm]
    Vec3 axis = Vec3(0, 0, -1);  // unit, from the tool into the body
};
/// A closed surface, where it stands at rest.
struct SurfaceShape {
    Surface surface;
};
/// No body of its own: the material that is gripped.
struct GripShape {
    std::vector<Region> regions;
};

/// A rigid body that touches the deformable one and is moved.
struct Tool {
    std::string name;
    std::variant<SphereShape, FlatShape, SurfaceShape, GripShape> shape;
    bool bonded = false;         // else without friction, and free to part
    Vec3 origin = Vec3::Zero();  // at rest [mm]: what it turns about, and moments are told about
};

/// Where a tool is in a state. A coordinate that is left free is NaN.
struct ToolMotion {
    int tool = 0;                     // index among the tools
    Vec3 translation = Vec3::Zero();  // of the origin, from rest [mm]
    Vec3 rotation = Vec3::Zero();     // rotation vector [rad]
};

}  // namespace palpate::mesh
