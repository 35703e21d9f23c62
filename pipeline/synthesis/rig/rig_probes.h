#pragma once

#include <vector>

#include "identify/models/rig.h"
#include "mesh/core/surface.h"
#include "pipeline/case/probe_options.h"
#include "pipeline/synthesis/loading/probe_load_history.h"

namespace palpate::pipeline {

/// A rig, and what it does to a body.
struct RigProbes {
    identify::Rig rig;
    std::vector<ProbeLoadHistory> histories;  // a row for each amount
    std::vector<std::string> notes;           // what a user should know, in words
};

/// A tool is pressed in to each depth at places spread over the free surface, a probe each, along the normal there; a
/// flat punch where the surface is square to its axis, which is that of the first place. Each value of an actuator is a
/// probe.
/// @throws InvalidInput for a tool, a point or a path that cannot be read, or a tool that finds no place.
RigProbes rig_probes(const mesh::Surface& surface, const std::vector<mesh::Region>& supports, const RigOptions& options,
                     const ProbeOptions& probing, std::uint64_t seed);

}  // namespace palpate::pipeline
