#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "pipeline/analysis/forecast/uncertainty.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::pipeline {

/// The skin's displacement in a state.
struct Forecast {
    skeleton::Equilibrium equilibrium;
    Points displacement;       // (vertices x 3) [mm]
    Eigen::VectorXd sd;        // of a coordinate, at each vertex: 95 % lie within 1.96 of it [mm]; empty: not known
    double largest = 0;        // displacement [mm]
    double low = 0, high = 0;  // where it lies with 95 % [mm]
};

/// In each state of probes, which creep until its time and keep what has flowed within a probe, with what is in doubt
/// where that is told. Draws that do not bear a load are left out.
///
/// Why 95 % of what is measured later lie within. The draws tell what stiffness leaves open, which is little: most of a
/// coarse model's error is structural and not reduced by any stiffness. Its size follows from probes left out of the
/// fit (leave_one_out_error); neither what it leaves where it was fitted nor the median that the likelihood weighs
/// readings by, as places differ by a factor of ten and the few bad ones make up most of the mean square. That mean
/// square is of n probes: an error over its root is Student's t with n degrees of freedom [Gelman et al., Bayesian Data
/// Analysis, 3.2].
/// @throws SolverFailure where the model itself does not.
std::vector<Forecast> forecast(const skeleton::Model& model, const std::vector<identify::LoadState>& states,
                               const std::optional<ModelUncertainty>& uncertainty, int threads);

/// Where forecasts go beyond what was measured, in words.
std::vector<std::string> extrapolations(const identify::MeasuredRange& measured,
                                        const std::vector<identify::LoadState>& states,
                                        const std::vector<Forecast>& forecasts, double size);

}  // namespace palpate::pipeline
