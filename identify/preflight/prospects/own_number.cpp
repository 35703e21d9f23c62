#include "identify/preflight/prospects/own_number.h"

#include <cmath>

namespace palpate::identify {
std::optional<OwnNumber> own_number(const EffectHypothesis& effect, const std::vector<EffectNumber>& numbers,
                                    const Eigen::VectorXd& values, double factor) {
    if (const std::optional<ScreenedNumber> number = effect.screened_number()) {
        if (number->name.empty()) return std::nullopt;
        return OwnNumber{number->name, number->unit, number->value(factor * values[0]), number->at_most};
    }
    if (values.size() != std::ssize(numbers)) return std::nullopt;
    // Numbers of one unit are a vector, which has a length.
    Eigen::VectorXd start(std::ssize(numbers));
    for (Eigen::Index j = 0; j < start.size(); ++j) start[j] = numbers[static_cast<std::size_t>(j)].start;
    const skeleton::EffectRecord none = effect.record(numbers, start);
    const skeleton::EffectRecord some = effect.record(numbers, start + factor * values);
    if (none.parameters.size() != some.parameters.size() || some.parameters.empty()) return std::nullopt;
    double squares = 0;
    for (std::size_t i = 0; i < some.parameters.size(); ++i) {
        if (some.parameters[i].unit != some.parameters.front().unit) return std::nullopt;
        squares += std::pow(some.parameters[i].value - none.parameters[i].value, 2);
    }
    const bool is_one = some.parameters.size() == 1;
    // Gains are told by how much they are off on average over those that there are.
    const bool are_ratios = some.parameters.front().unit == "1";
    const auto count = static_cast<double>(some.parameters.size());
    return OwnNumber{is_one ? some.parameters.front().name : effect.name(), some.parameters.front().unit,
                     std::sqrt(are_ratios ? squares / count : squares)};
}

}  // namespace palpate::identify
