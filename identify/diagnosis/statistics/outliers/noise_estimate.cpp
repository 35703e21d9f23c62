#include "identify/diagnosis/statistics/outliers/noise_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/statistics/outliers/outliers.h"

namespace palpate::identify {
namespace {

constexpr const char* noise_note = "The set does not tell its noise: ";

}  // namespace

bool tells_noise(const MeasurementSet& set) {
    return set.position_noise || std::ranges::all_of(set.states, [](const LoadState& state) {
               return std::ranges::none_of(state.readings, [](const Reading& r) { return std::isnan(r.sigma); });
           });
}

void estimate_noise_from(const Refit& fit, double moved, double resolution, Problem& problem,
                         std::vector<std::string>& notes) {
    // What is rough in the errors is noise: a missing effect is smooth from marker to marker. Errors of few readings
    // that are trusted less are as they are, a median bears them.
    const Eigen::VectorXd error_mm = fit.residual.cwiseQuotient(fit.V->weights()).cwiseProduct(problem.sigma);
    const double rough = noise_by_roughness(problem, error_mm);
    constexpr double least = 1e-12;  // [mm], where nothing moved: a sigma is above 0
    const double finest = std::max(resolution * moved, least);
    const double noise = std::max(rough, finest);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (problem.is_guessed[n]) problem.sigma[n] = noise;
    }
    std::erase_if(notes, [](const std::string& note) { return note.starts_with(noise_note); });
    notes.push_back(
        rough >= finest
            ? fmt::format("{}{:.3g} mm, from how errors differ between neighbouring markers.", noise_note, noise)
            : fmt::format("{}errors hardly differ between neighbouring markers, and are weighed with "
                          "{:.3g} mm, {:g} % of the displacement, which a mesh may be off by.",
                          noise_note, noise, 100 * resolution));
}

}  // namespace palpate::identify
