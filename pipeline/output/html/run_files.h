#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/inference/posterior_row.h"
#include "pipeline/analysis/density.h"
#include "pipeline/output/html/charts/picture.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// All that a page is made of, read from the run folder.
struct RunFiles {
    nlohmann::json record, compare;
    nlohmann::json diagnosis, ladder, quality;  // null where the run did not ask
    nlohmann::json improved;                    // compare.json of the model with all effects in; null: none was added
    std::vector<std::string> notes;             // of the identification of the model to use
    std::string settings;
    std::string best;                               // the folder of the model to use: "improve" where there is one
    std::vector<identify::PosteriorRow> posterior;  // of that model
    ParticleSet particles;                          // of the same identification; there may be none
    PriorKind prior = PriorKind::log_normal;
    skeleton::Model model;
    std::vector<Dot> errors_before, errors_after;  // rms of each marker; after: with all effects in, may be empty
};

/// The effects that are in a ladder's last step.
std::vector<std::string> added_effects(const RunFiles& files);

/// "nothing added" or "with gravity".
std::string with_what(const RunFiles& files);

/// @throws IoError, InvalidInput naming the file that is missing or broken.
RunFiles read_run(const std::filesystem::path& run);

}  // namespace palpate::pipeline
