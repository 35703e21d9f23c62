#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/effects/effect.h"

namespace palpate::identify {

/// How strong an effect is in a unit of its own.
struct OwnNumber {
    std::string name, unit;  // "gravity" in "mm/s^2"; unit "1": a bare number
    double value = 0;
    bool at_most = false;  // the weaker the effect, the larger the number, as the stiffness of a soft support
};

/// The strength behind screened values (p), `factor` times as large; none: it has no one number, as a shift and a turn
/// together.
std::optional<OwnNumber> own_number(const EffectHypothesis& effect, const std::vector<EffectNumber>& numbers,
                                    const Eigen::VectorXd& values, double factor);

}  // namespace palpate::identify
