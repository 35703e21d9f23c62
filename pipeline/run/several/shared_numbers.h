#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/analysis/mean_specimen.h"
#include "pipeline/analysis/specimens.h"

namespace palpate::pipeline {

/// What specimens have in common.
struct SharedBySpecimens {
    std::vector<SharedNumber> numbers;
    MeanSpecimen mean;
    std::size_t left_out = 0;  // numbers of single links, where skeletons do not correspond
};

/// What two runs or more tell: stiffness of the body in finite elements and of the skeleton, and the numbers of the
/// effects that their diagnoses name. Single links only where the skeletons correspond: else link 3 of one is another
/// place than link 3 of the next. @throws IoError, InvalidInput naming the run, for less than two runs, one that is
/// told twice, or runs that share no number.
SharedBySpecimens shared_by_specimens(const std::vector<std::filesystem::path>& runs);

}  // namespace palpate::pipeline
