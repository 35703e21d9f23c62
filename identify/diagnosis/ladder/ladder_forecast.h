#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>

#include "identify/diagnosis/ladder/ladder_step.h"

namespace palpate::identify {

/// In words, where `now` is at least `most` times as far off on held-out probes as `before`, on the body or on the
/// skeleton.
std::optional<std::string> what_is_worse(const LadderStep& before, const LadderStep& now, double most);

/// A fault of the measurement may differ from probe to probe: of a held-out one its spread alone is known. Is `effect`,
/// which `now` has and `before` lacks, one, and are held-out probes of the body forecast better with it, as normalised
/// errors have it?
bool is_forecast_by_its_spread(const std::string& effect, const LadderStep& before, const LadderStep& now);

/// Mean squares of several folds together, each by the rows of its kind.
class PooledError {
public:
    void add(double rms, Eigen::Index rows) {
        if (rows == 0) return;
        squares_ += static_cast<double>(rows) * rms * rms;
        rows_ += rows;
    }
    double rms() const { return rows_ > 0 ? std::sqrt(squares_ / static_cast<double>(rows_)) : missing; }

private:
    double squares_ = 0;
    Eigen::Index rows_ = 0;
};

}  // namespace palpate::identify
