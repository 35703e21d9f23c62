#pragma once

#include <string>
#include <vector>

#include "skeleton/model.h"

namespace palpate::pipeline {

/// A value at a place, to be drawn as a coloured dot.
struct Dot {
    Vec3 at;
    double value;
    bool strange = false;  // gets a ring
};

/// The body seen from one side as SVG: its surface in grey, spheres, links coloured by elongation stiffness.
std::string skeleton_picture(const skeleton::Model& model);

/// The body's surface in grey with dots coloured by value.
std::string dot_picture(const skeleton::Model& model, const std::vector<Dot>& dots, const std::string& unit);

}  // namespace palpate::pipeline
