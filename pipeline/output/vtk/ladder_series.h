#pragma once

#include <filesystem>

#include "identify/diagnosis/ladder/ladder.h"

namespace palpate::pipeline {

/// ladder.pvd: a step of time for each step of the ladder, so that playing it shows the error fall. The markers of all
/// states stand where they were measured, with "error [mm]" (from model to measurement), "displacement [mm]" (of the
/// model), "measured [mm]", "probe" and "time". ladder_skin.pvd and ladder_markers.pvd: the one state that the first
/// step errs most in, step by step, of the files that the steps' own series hold.
void write_ladder_series(const std::filesystem::path& folder, const identify::Ladder& ladder);

}  // namespace palpate::pipeline
