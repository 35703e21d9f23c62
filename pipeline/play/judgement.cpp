#include "pipeline/play/judgement.h"

#include "identify/fit/lived.h"

namespace palpate::pipeline {

Judgement::Judgement(skeleton::Model model, const identify::MeasurementSet& set)
    : model_(std::move(model)),
      readings_(identify::collect_readings(model_, set)),
      solver_(model_),
      k_(skeleton::stiffness_vector(model_)),
      so_far_(readings_.size()),
      played_(readings_.size()) {}

Judgement::Error Judgement::judge(int r) {
    const identify::StateReadings& own = readings_[r];
    const identify::Lived before = identify::lived_as_far_as_it_bears(model_, solver_, k_, readings_, r, so_far_);
    played_[r] = identify::solve_as_far_as_it_bears(solver_, k_, own.load, before.flowed);
    so_far_[r] = played_[r].equilibrium;
    const Points predicted = skeleton::observed(model_, so_far_[r], played_[r].load, own.points);
    const Points error = (own.measured - predicted).array().isNaN().select(0, own.measured - predicted);
    return {error.squaredNorm(), own.coordinates, before.whole && played_[r].whole};
}

}  // namespace palpate::pipeline
