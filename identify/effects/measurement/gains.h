#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/effects/hiding.h"

namespace palpate::identify {

/// The number of a record that is least, or most, by name and in words with how well it is known.
struct ExtremeGain {
    std::string name, in_words;
};

/// The least and the most of a record's gains. @pre it has one @param covariance as number_in_words
struct GainRange {
    ExtremeGain least, most;
};
GainRange gain_range(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance);

/// Draws a "gain" above or below 1, as likely either.
std::vector<EffectSampler> gain_samplers(SamplingContext& context, const SpecifiedNumbers& specified);

}  // namespace palpate::identify
