#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnose_options.h"

namespace palpate::pipeline {

/// What is known of the gravity that acts, where it is not told.
enum class GravityKnown {
    automatic,  // as earth is an alternative where the density is told, else as unknown
    earth,      // 9.8 m/s^2, in any direction
    unknown,    // a phantom may float
};

/// Diagnosis options of a run.
struct RunDiagnosisOptions {
    bool reference = true;             // on the body in finite elements; false: it is not asked
    std::vector<std::string> without;  // effects left out of the catalogue
    GravityKnown gravity = GravityKnown::automatic;
    double false_claims = identify::DiagnoseOptions{}.false_claims;  // at most, of sets in which nothing is missing

    /// `has_density`: is the body's density told?
    identify::DiagnoseOptions in_set(bool has_density) const;
    void validate() const;
};

}  // namespace palpate::pipeline
