#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "identify/inference/identify_result.h"

namespace palpate::pipeline {

/// Weighted particles that stand for a posterior.
struct ParticleSet {
    std::vector<std::string> parameters;  // names, as in posterior.csv (P)
    Eigen::MatrixXd stiffness;            // (particles x P), units as in posterior.csv
    Eigen::VectorXd weights;              // (particles), they add up to 1
};

/// particles.csv: weight and stiffnesses, a row a particle. Empty of rows where the result has no particles.
std::string particles_csv(const identify::IdentifyResult& found);

/// @throws IoError, InvalidInput naming file and line.
ParticleSet read_particles(const std::filesystem::path& file);

}  // namespace palpate::pipeline
