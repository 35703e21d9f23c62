#pragma once

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// How well a skeleton's spheres fill its body, where no support holds it.
struct ShapeQuality {
    double coverage = 0;        // largest distance of a vertex of the surface outside the spheres [mm]
    double coverage_share = 0;  // the same, of the longest side
    double covered = 0;         // share of the body's volume that lies in the spheres, [0, 1]
    double outside = 0;         // share of the spheres' union that lies outside the body, [0, 1]
};

/// Volumes are counted on a grid of 1/128 of the longest side, good to about half a per cent.
/// @pre the model's surface is closed.
ShapeQuality shape_quality(const skeleton::Model& model);

}  // namespace palpate::pipeline
