#pragma once

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

// What a user should know of a diagnosis beside its verdict, appended to its notes.

/// That outliers were set aside, and which markers look exchanged. `readings`: how many there were before.
void note_outliers(const MeasurementSet& set, int readings, Diagnosis& diagnosis);

/// What limits a finished diagnosis: errors of the mesh, and a magnitude that was assumed. `moved`: readings from rest,
/// rms [mm].
void note_limits(const DiagnoseOptions& options, double moved, Diagnosis& diagnosis);

}  // namespace palpate::identify
