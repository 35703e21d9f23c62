#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "identify/identify.h"
#include "skeleton/equilibrium.h"

namespace palpate::pipeline {

/// What an identification left open about a model.
struct Doubts {
    std::vector<Eigen::VectorXd> draws;  // stiffnesses from the posterior, equally likely, as StiffnessOrder says
    double model_error = 0;              // of a prediction over its displacement, beyond what the draws tell
    identify::MeasuredRange measured;
};

/// Reads particles.csv and identify.json of the folder; nothing where it has no particles. `count` draws at most, the
/// same ones each time. @throws IoError, InvalidInput naming the file, also where it belongs to another model.
std::optional<Doubts> read_doubts(const skeleton::Model& model, const std::filesystem::path& folder, int count);

/// The skin's displacement under a load.
struct Forecast {
    skeleton::Equilibrium equilibrium;
    Points displacement;       // (vertices x 3) [mm]
    Eigen::VectorXd sd;        // of a coordinate, at each vertex [mm]; empty: not known
    double largest = 0;        // displacement [mm]
    double low = 0, high = 0;  // 95 % of the posterior there [mm]
};

/// Under each load, with what is in doubt where that is told. Draws that do not bear a load are left out.
/// @throws SolverFailure where the model itself does not.
std::vector<Forecast> forecast(const skeleton::Model& model, const std::vector<skeleton::Load>& loads,
                               const std::optional<Doubts>& doubts, int threads);

/// Where forecasts go beyond what was measured, in words.
std::vector<std::string> extrapolations(const identify::MeasuredRange& measured,
                                        const std::vector<identify::LoadState>& states,
                                        const std::vector<Forecast>& forecasts, double size);

}  // namespace palpate::pipeline
