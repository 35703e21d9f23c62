#pragma once

#include "identify/measurements/measurement_set.h"
#include "identify/motion/damping_result.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// Makes the model vibrate as fast as the body, where its masses are a guess: the set tells no density, and nothing
/// weighs. Otherwise the masses stay, the damping is made such that the model dies away in as many cycles as the body,
/// and a note says what differs. Nothing changes where the speed is not informed, or nearly that of the model.
void match_vibration_speed(skeleton::Model& model, const MeasurementSet& set, DampingResult& result);

}  // namespace palpate::identify
