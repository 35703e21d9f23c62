#pragma once

#include <vector>

#include "identify/set/measurement_set.h"
#include "skeleton/model.h"

namespace palpate::samples {

/// One of the paper's two experiments, rebuilt [Burion 2008, section IV]: a lattice of spheres 40 mm apart with links
/// between neighbours, held at x = 0; kE .8-2.8 N/mm, kF 250-900 N mm/rad as read from its figures 3 and 5.
struct Experiment {
    skeleton::Model start;                    // kE 2 N/mm, kF 750 N mm/rad, kT 500 N mm/rad everywhere
    identify::MeasurementSet set;             // six forces on the truth, four markers a sphere
    std::vector<double> elongation, flexion;  // the truth, of each zone
};

/// I: a homogeneous cube of 3 x 3 x 2 spheres.
Experiment make_cube_experiment();

/// II: a sheet of 6 x 3 spheres in three zones.
Experiment make_sheet_experiment();

}  // namespace palpate::samples
