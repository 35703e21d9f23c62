#pragma once

#include <cstdint>

#include "identify/set/measurement_set.h"
#include "pipeline/case/case.h"
#include "skeleton/model.h"

namespace palpate::pipeline {

/// Probes a skeleton itself, which is the hidden truth: an unloaded state, and a force on one free sphere after the
/// other, those far from each other first, each in a direction of its own, drawn by `seed`. Forces are
/// scaled so that the loaded sphere moves by `displacement` of the longest side by the linear answer. Four markers
/// a sphere tell position and rotation. [Burion 2008, section IV]
identify::MeasurementSet probe_twin(const skeleton::Model& model, const ProbeOptions& options, std::uint64_t seed);

}  // namespace palpate::pipeline
