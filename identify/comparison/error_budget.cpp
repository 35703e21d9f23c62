#include "identify/comparison/error_budget.h"

#include <algorithm>

namespace palpate::identify {

ErrorBudget split_error_budget(double mean_square_error, double noise_variance, double left_by_reference) {
    if (mean_square_error <= noise_variance) return {.noise = 1};
    ErrorBudget budget{.noise = noise_variance / mean_square_error};
    const double beyond_noise = (left_by_reference - noise_variance) / mean_square_error;
    budget.missing_physics = std::clamp(beyond_noise, 0.0, 1 - budget.noise);
    budget.reduction = 1 - budget.noise - budget.missing_physics;
    return budget;
}

}  // namespace palpate::identify
