#pragma once

#include <optional>
#include <string>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A skeleton, and what its specimen is called.
struct SpecimenModel {
    std::string name;
    skeleton::Model model;
};

/// The mean of specimens whose skeletons and meshes correspond: a sphere, a link or a vertex of a number is the same
/// place in all of them.
struct MeanSpecimen {
    std::optional<skeleton::Model> model;  // the first one's, with mean spheres and surface, without effects
    std::string why_none;                  // in words, where they do not correspond
};

/// They correspond where they have equally many spheres, links between the same of them, and triangles of the same
/// vertices. @pre there is one
MeanSpecimen mean_specimen(const std::vector<SpecimenModel>& specimens);

}  // namespace palpate::pipeline
