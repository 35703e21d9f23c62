#include "identify/diagnosis/diagnose_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/statistics/largest_noise.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {

bool DiagnoseOptions::leaves_out(const EffectHypothesis& effect) const {
    return std::ranges::find(without, effect.name()) != without.end();
}

double DiagnoseOptions::least_evidence() const {
    const auto effects = std::ranges::count_if(catalogue(), [&](const auto& effect) { return !leaves_out(*effect); });
    return std::log(static_cast<double>(std::max<std::ptrdiff_t>(effects, 1)) / false_claims);
}

double DiagnoseOptions::most_left(Eigen::Index readings) const {
    return std::max(1 + noise_accuracy, largest_noise(readings, false_refusals));
}

void DiagnoseOptions::validate() const {
    const auto probability = [](const char* name, double value) {
        if (!(value > 0 && value < 1))
            throw InvalidInput(fmt::format("{} is {}; allowed: above 0 and below 1", name, value));
    };
    probability("false_claims", false_claims);
    probability("false_refusals", false_refusals);
    for (const std::string& name : without) find_effect(name);
    const auto above = [](const char* name, double value) {
        if (!(value > 0)) throw InvalidInput(fmt::format("{} is {}; it must be above 0", name, value));
    };
    above("most_pull", most_pull);
    const auto no_less = [](const char* name, double value) {
        if (!(value >= 0)) throw InvalidInput(fmt::format("{} is {}; it must be 0 or more", name, value));
    };
    no_less("noise_accuracy", noise_accuracy);
    no_less("mesh_error", mesh_error);
    no_less("resolution", resolution);
    no_less("idealisation_evidence", idealisation_evidence);
    no_less("least_outliers", least_outliers);
    if (refit.steps < 1) throw InvalidInput(fmt::format("refit.steps is {}; allowed: 1 and more", refit.steps));
    if (refits < 1) throw InvalidInput(fmt::format("refits is {}; allowed: 1 and more", refits));
    if (together < 1) throw InvalidInput(fmt::format("together is {}; allowed: 1 and more", together));
}

}  // namespace palpate::identify
