#pragma once

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A skeleton's graph beside the body that it stands for: the left of a pair is the body's.
struct GraphQuality {
    int body_parts = 0, parts = 0;      // that hang together
    int body_handles = 0, handles = 0;  // holes through it: independent loops, those of the body being filled
    int loops = 0;                      // independent ones of the bare graph, links - spheres + parts
    int links_outside = 0;              // links that leave the body on their way
};

/// The body's handles are the genus of its surfaces, added up. The graph's are its loops once each ring of three or
/// four links is filled whose middle lies in the body: those that are left go round a hole.
/// @pre the model's surface is closed.
GraphQuality graph_quality(const skeleton::Model& model);

}  // namespace palpate::pipeline
