#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "identify/inference/identify_result.h"

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

}  // namespace palpate::pipeline
