#include "fem/effects/local/stiffness_map.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

#include "mesh/errors.h"

namespace palpate::fem {

StiffnessMap::StiffnessMap(Points places, Eigen::VectorXd amplitudes, double length)
    : places_(std::move(places)),
      amplitudes_(std::move(amplitudes)),
      mean_weights_(Eigen::VectorXd::Zero(amplitudes_.size())),
      length_(length) {
    assert(places_.rows() > 0 && places_.rows() == amplitudes_.size() && length > 0);
    for (const auto& place : places_.rowwise()) mean_weights_ += weights(place);
    mean_weights_ /= static_cast<double>(places_.rows());
    mean_ = mean_weights_.dot(amplitudes_);
}

Eigen::VectorXd StiffnessMap::weights(const Vec3& X) const {
    const Eigen::VectorXd exponents =
        -0.5 * (places_.rowwise() - X.transpose()).rowwise().squaredNorm() / (length_ * length_);
    // The nearest kernel counts as 1: far from all of them, where each is 0, the nearest is what is left.
    const Eigen::VectorXd kernels = (exponents.array() - exponents.maxCoeff()).exp();
    return kernels / kernels.norm();
}

StiffnessMap stiffness_map(const EffectNumbers& numbers) {
    int count = 0;
    while (count < most_places && numbers.has(fmt::format("a{}", count + 1))) ++count;
    if (count == 0) throw InvalidInput("it has no places: x1, y1, z1 [mm] and a1, and so on, must be given");
    Points places(count, 3);
    Eigen::VectorXd amplitudes(count);
    for (int i = 0; i < count; ++i) {
        for (const char* axis : {"x", "y", "z"}) {
            const std::string name = fmt::format("{}{}", axis, i + 1);
            if (!numbers.has(name))
                throw InvalidInput(fmt::format("'{}' [mm] is missing, of the place of a{}", name, i + 1));
        }
        places.row(i) = numbers.vector(fmt::format("x{}", i + 1), fmt::format("y{}", i + 1), fmt::format("z{}", i + 1));
        amplitudes[i] = numbers[fmt::format("a{}", i + 1)];
    }
    for (int i = count; i < most_places; ++i)
        for (const char* part : {"x", "y", "z", "a"})
            if (numbers.has(fmt::format("{}{}", part, i + 1)))
                throw InvalidInput(
                    fmt::format("'{}{}' is given, but a{} is not: places are numbered from 1 without gaps", part, i + 1,
                                count + 1));
    return {std::move(places), std::move(amplitudes), numbers["length"]};
}

KnownEffect known_stiffness_map() {
    std::vector<KnownParameter> parameters{{"length", "mm", Range::positive}};
    for (int i = 1; i <= most_places; ++i) {
        for (const char* axis : {"x", "y", "z"})
            parameters.push_back(optional_parameter(fmt::format("{}{}", axis, i), "mm"));
        parameters.push_back(optional_parameter(fmt::format("a{}", i), "1"));
    }
    return {"map", std::move(parameters), [](const EffectNumbers& numbers) -> Effects {
                return {.material = {std::make_shared<StiffnessMap>(stiffness_map(numbers))}};
            }};
}

}  // namespace palpate::fem
