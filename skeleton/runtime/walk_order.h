#pragma once

#include <vector>

#include "skeleton/model/model.h"

namespace palpate::runtime {

/// A model reordered for memory locality.
struct ReorderedModel {
    skeleton::Model model;   // spheres as a walk from link to link meets them, links by their ends
    std::vector<int> place;  // in it, of each sphere of the model that it comes from
};

/// Orders spheres breadth first, fewer neighbours first, from one of fewest. [Cuthill & McKee 1969]
ReorderedModel in_cuthill_mckee_order(const skeleton::Model& model);

}  // namespace palpate::runtime
