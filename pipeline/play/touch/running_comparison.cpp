#include "pipeline/play/touch/running_comparison.h"

#include "identify/loading/history/load_history.h"

namespace palpate::pipeline {

RunningComparison::RunningComparison(skeleton::Model model, const identify::MeasurementSet& set)
    : model_(std::move(model)),
      readings_(identify::collect_readings(model_, set)),
      solver_(model_),
      k_(skeleton::stiffness_vector(model_)),
      so_far_(readings_.size()),
      played_(readings_.size()) {}

RunningComparison::Error RunningComparison::evaluate(int r) {
    const identify::StateReadings& own = readings_[r];
    const identify::LoadHistory before =
        identify::reduced_load_history_before(model_, solver_, k_, readings_, r, so_far_);
    played_[r] = identify::solve_with_reduced_load(solver_, k_, own.load, before.flowed);
    so_far_[r] = played_[r].equilibrium;
    const Points predicted = skeleton::observed(model_, so_far_[r], played_[r].load, own.points);
    const Points error = (own.measured - predicted).array().isNaN().select(0, own.measured - predicted);
    return {error.squaredNorm(), own.coordinates, before.is_full_load && played_[r].is_full_load};
}

}  // namespace palpate::pipeline
