#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "pipeline/case/case.h"
#include "pipeline/synthesis/external_solver/results_folder.h"
#include "pipeline/synthesis/loading/reading_faults.h"

namespace palpate::pipeline {

struct ForeignOptions {
    std::filesystem::path folder;  // of the solver's results
    std::string array = {};        // of displacements, in .vtu and .vtp files; empty: found by its name
    ReadingFaults faults = {};     // put into the readings
    std::uint64_t seed = 1;
};

/// A measurement set out of another solver's fields.
struct ForeignSet {
    identify::MeasurementSet set;
    ResultsFolder results;
    std::string array;
    double unit = 1;                 // of the solver's lengths [mm]
    std::vector<std::string> notes;  // what a user should know, in words
};

/// Markers are nodes of the solver's own surface, spread over what it does not hold, where it told all fields: their
/// readings are its numbers. Other meshes of later files are interpolated. The body is held where `settings` say, else
/// where the deck holds it, else where no field moves it. The solver's lengths are in the unit of the body's mesh.
/// @throws IoError, InvalidInput, where the fields lie elsewhere than the body with the likely cause.
ForeignSet foreign_set(Case settings, const ForeignOptions& options, const Progress& progress = {});

/// Writes it, with the full fields of solid cells (field/<probe>_<time>.vtu) [mm].
void write_foreign_set(const std::filesystem::path& folder, const ForeignSet& foreign);

}  // namespace palpate::pipeline
