#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "identify/inference/identify_result.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::pipeline {

/// Posterior uncertainty of an identified model.
struct ModelUncertainty {
    std::vector<Eigen::VectorXd> draws;      // stiffnesses from the posterior, equally likely, as StiffnessOrder says
    identify::ForecastError forecast_error;  // 0 where it was not estimated
    identify::MeasuredRange measured;
};

/// Reads particles.csv and identify.json of the folder; nothing where it has no particles. `count` draws at most, the
/// same ones each time. @throws IoError, InvalidInput naming the file, also where it belongs to another model.
std::optional<ModelUncertainty> read_uncertainty(const skeleton::Model& model, const std::filesystem::path& folder,
                                                 int count);

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
