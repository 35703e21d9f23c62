#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// The effects of what a diagnosis explains best, as they are told; outliers that were set aside are one of them.
std::vector<skeleton::EffectRecord> estimate(const Diagnosis& diagnosis);

/// The measurements without the faults that are known, and without outliers where these are one of them.
MeasurementSet understood(const MeasurementSet& set, const std::vector<skeleton::EffectRecord>& effects,
                          const std::vector<int>& outliers);

/// Is one among these effects that sets readings aside?
bool set_readings_aside(const std::vector<std::string>& effects);

/// @throws InvalidInput where the effect has no numbers in this body and this set.
void refuse_what_cannot_show(const EffectHypothesis& effect, const BodyModel& body, const MeasurementSet& set);

}  // namespace palpate::identify
