#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// A part of a body's surface that needs shorter edges.
struct FineZone {
    Vec3 at = Vec3::Zero();  // on the surface [mm]
    double radius = 0;       // [mm]
    double edge = 0;         // within it [mm]
};

/// Where a set's tools press: as far as each reaches, by Hertz where it is round, with edges of two fifths of that.
/// Where there are so many that they would take more than 6,000 quadratic nodes, edges are longer.
std::vector<FineZone> contact_zones(const identify::MeasurementSet& set);

/// The edge length wanted at a place: `edge` far away, growing by four fifths of the distance from the zones [mm].
double edge_at(const Vec3& place, const std::vector<FineZone>& zones, double edge);

}  // namespace palpate::pipeline
