#pragma once

#include <string>
#include <vector>

namespace palpate::pipeline {

/// Diagnosis options of a run.
struct RunDiagnosisOptions {
    bool reference = true;             // on the body in finite elements; false: it is not asked
    std::vector<std::string> without;  // effects left out of the catalogue
    void validate() const;
};

}  // namespace palpate::pipeline
