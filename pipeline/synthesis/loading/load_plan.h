#pragma once

#include "mesh/progress.h"
#include "pipeline/synthesis/loading/load_sequence.h"
#include "pipeline/synthesis/loading/simulation.h"

namespace palpate::pipeline {

/// What is done to a specimen, and how it stands then without anything hidden in it.
struct Plan {
    std::vector<ProbeLoadHistory> histories;  // first the untouched body
    std::vector<EquilibriumPath> baseline;    // of each
    std::vector<std::string> notes;           // what a user should know, in words
};

/// Courses whose loads move the specimen as far as is asked: at each level the force is scaled until the largest
/// displacement is that share of `largest` [mm], within 2 %, by secants on the body itself; less where the force would
/// pass what a contact may bear. It is scaled with nothing hidden in force: so the same seed and options give the same
/// forces whatever is hidden, and what differs between two sets is what the hidden effect does.
/// A probe that finds no equilibrium presses less, and is left out when that does not help.
/// Where a rig drives the specimen its probes are as they were asked for.
/// @throws SolverFailure when no probe is left.
Plan make_plan(const Specimen& specimen, const Sequence& sequence, double largest, int threads,
               const Progress& progress = {});

/// The same histories with the forces of some (flags) reduced, their bare paths found anew; those that find no
/// equilibrium are left out.
void reduce_forces(const Specimen& specimen, Plan& plan, const std::vector<char>& which, int threads);

/// Leaves histories (flags) out.
void leave_out(Plan& plan, const std::vector<char>& which);

}  // namespace palpate::pipeline
