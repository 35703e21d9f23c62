#include "identify/effects/measurement/gains.h"

#include <algorithm>
#include <cmath>

#include "identify/effects/vector_words.h"

namespace palpate::identify {

GainRange gain_range(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) {
    const auto [least, most] = std::ranges::minmax_element(record.parameters, {}, &skeleton::EffectParameter::value);
    const auto told = [&](auto gain) {
        const auto number = static_cast<std::size_t>(gain - record.parameters.begin());
        return ExtremeGain{gain->name, number_in_words(record, number, covariance)};
    };
    return {told(least), told(most)};
}

std::vector<EffectSampler> gain_samplers(SamplingContext& context, const SpecifiedNumbers& specified) {
    constexpr double largest = 100;  // that may be specified: a choice, beyond any sensor's fault
    constexpr double most = 4;       // that is looked for, or its inverse: a choice
    specified.positive_value("gain", 1, largest);
    const double sign = context.random.uniform() < 0.5 ? -1 : 1;
    const auto at = [=](double x) { return specified.effect({{"gain", std::exp(sign * x)}}); };
    return {{.at = at, .start = 0.3, .most = std::log(most), .is_specified = specified.has("gain")}};
}

}  // namespace palpate::identify
