#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::pipeline {

/// A part of a body's surface that needs shorter edges.
struct FineZone {
    Vec3 at = Vec3::Zero();  // on the surface [mm]
    double radius = 0;       // [mm]
    double edge = 0;         // within it [mm]
};

/// Where tools that are moved so press into a body: as far as each reaches, by Hertz where it is round, with edges of
/// two fifths of that. One that does not touch has no zone.
std::vector<FineZone> zones_touched(const std::vector<mesh::Tool>& tools, const std::vector<mesh::ToolMotion>& motions,
                                    const mesh::SurfaceTree& body);

/// The same zones with edges so long that all take about 6,000 quadratic nodes at most.
std::vector<FineZone> affordable(std::vector<FineZone> zones);

/// Where a set's tools press in any state, affordable.
std::vector<FineZone> contact_zones(const identify::MeasurementSet& set);

/// The edge length wanted at a place: `edge` far away, growing by four fifths of the distance from the zones [mm].
double edge_at(const Vec3& place, const std::vector<FineZone>& zones, double edge);

}  // namespace palpate::pipeline
