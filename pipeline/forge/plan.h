#pragma once

#include "mesh/progress.h"
#include "pipeline/case/case.h"
#include "pipeline/forge/play.h"

namespace palpate::pipeline {

/// What is done to a specimen, and how it stands then without anything hidden in it.
struct Plan {
    std::vector<Course> courses;     // first the untouched body
    std::vector<Path> bare;          // of each
    std::vector<std::string> notes;  // what a user should know, in words
};

/// Courses whose loads move the specimen as far as is asked: at each level the force is scaled until the largest
/// displacement is that share of `largest` [mm], within 2 %, by secants on the body itself; less where the force would
/// pass what a contact may bear. It is scaled with nothing hidden in force: so the same seed and options give the same
/// forces whatever is hidden, and what differs between two sets is what the hidden effect does.
/// A probe that finds no equilibrium presses less, and is left out when that does not help.
/// @throws SolverFailure when no probe is left.
Plan make_plan(const Specimen& specimen, const ForgeOptions& options, const Rhythm& rhythm, double largest, int threads,
               const Progress& progress = {});

/// The same courses with the forces of some (flags) reduced, their bare paths found anew; those that find no
/// equilibrium are left out.
void press_less(const Specimen& specimen, Plan& plan, const std::vector<char>& which, int threads);

/// Leaves courses (flags) out.
void leave_out(Plan& plan, const std::vector<char>& which);

}  // namespace palpate::pipeline
