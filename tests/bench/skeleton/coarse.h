#pragma once

#include "pipeline/analysis/quality/errors.h"
#include "pipeline/analysis/quality/probed_body.h"

namespace palpate::bench {

/// What a user would do in place of a skeleton: few finite elements.
struct CoarseBody {
    int free_nodes = 0;
    double scale = 1;  // of Young's modulus, as the fitted probes have it
    pipeline::ErrorSummary held_out;
};

/// Quadratic tetrahedra in small strain with about so many free nodes, as near as meshes come to it; Young's modulus
/// scaled so that the probes that skeletons are fitted to come out best, each counted alike.
/// @throws SolverFailure where no mesh is sound.
CoarseBody coarse_body(const pipeline::Subject& subject, const pipeline::ProbedQuality& probed, int free_nodes);

}  // namespace palpate::bench
