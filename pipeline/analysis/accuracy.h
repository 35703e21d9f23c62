#pragma once

#include <optional>

#include "fem/elastic_body.h"
#include "identify/measurements/measurement_set.h"
#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

/// How far a reference simulation may be off, by a second mesh.
struct ReferenceAccuracy {
    double relative = 0;      // error of the markers' displacements, rms over rms
    double difference = 0;    // of the coarser mesh's displacements from it, rms over rms
    double coarser_edge = 0;  // of that mesh [mm]
    Eigen::Index coarser_nodes = 0;
};

/// Solves some of the set's states, spread evenly, on a mesh with edges half as long again. Where the error falls with
/// the edge to the power p, u_h - u = (u_H - u_h) / ((H / h)^p - 1) [Richardson 1911]. Quadratic elements: p = 2, as at
/// the rim of contacts and clamps; where fields are smooth it falls faster, and the estimate is on the safe side.
/// Linear ones, stiff in bending: p = 1. How each mesh holds the supports, and cuts off round surfaces, is part of it.
/// `edge`: of the body's elements [mm]. None for a ready-made mesh, and where the coarser one cannot be made.
std::optional<ReferenceAccuracy> estimate_accuracy(const Subject& subject, const fem::ElasticBody& body, double edge,
                                                   const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
