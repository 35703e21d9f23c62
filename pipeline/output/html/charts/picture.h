#pragma once

#include <string>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A value at a place, to be drawn as a coloured dot.
struct Dot {
    Vec3 at;
    double value;
    bool strange = false;  // gets a ring
};

/// The body seen from one side as SVG: its surface in grey, spheres, links coloured by elongation stiffness. The page
/// holds the surface here once, for the other pictures too.
std::string skeleton_picture(const skeleton::Model& model);

/// What is known of a skeleton's links, to be drawn as colours.
struct LinkValues {
    Eigen::VectorXd values;  // (links); NaN: not known, and drawn thin
    bool is_logarithmic = false;
    std::string words;  // what they are, with their unit
};
/// The body's surface in grey (of the page's first picture, which says so) with links coloured by their values.
std::string link_picture(const skeleton::Model& model, const LinkValues& values, bool is_first);

/// The body's surface in grey (of the skeleton's picture, on the same page) with dots coloured by value, from 0 to
/// `highest`.
std::string dot_picture(const skeleton::Model& model, const std::vector<Dot>& dots, double highest,
                        const std::string& unit);

}  // namespace palpate::pipeline
