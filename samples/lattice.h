#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::samples {

/// A lattice of n(x,y,z) spheres 40 mm apart in `zones` of even length along x, links between neighbours, held at x =
/// 0, in a box whose sides pass through the outer spheres. kE 2 N/mm, kF 750 N mm/rad, kT 500 N mm/rad.
skeleton::Model make_lattice(const std::string& name, const Eigen::Vector3i& n, int zones);

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

/// Two strings in line, one three times as stiff as the other, held at both ends, pushed along and across where they
/// meet; a depth gauge reads that point along the push alone. What it reads tells both stiffnesses, and not which is
/// whose: along, 1 / (k1 + k2); far across, by how they stretch, k1 k2 / (k1 + k2).
Experiment make_two_strings();

}  // namespace palpate::samples
