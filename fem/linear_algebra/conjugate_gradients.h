#pragma once

#include "fem/linear_algebra/multigrid/multigrid.h"

namespace palpate::fem {

struct ConjugateGradientsOptions {
    double tolerance = 1e-11;  // of the error's energy norm, as a share of the solution's, > 0; estimated
    int iterations = 500;      // at most, >= 1
    bool truncated = false;    // end without an answer in place of failing: see below
};

/// X <- A^-1 X, with A the multigrid's matrix; all columns at once, each with its own steps. The energy norm of the
/// error is estimated as sqrt(r . M r) against that at the start, which is off by the root of the condition of M A at
/// most.
/// Truncated, a column ends where A is not positive along its direction, or when the iterations are used up, with what
/// it has: a direction of descent. [Steihaug 1983]
/// @return iterations. @throws SolverFailure with iterations and error when they do not suffice, and
/// where A is singular.
int conjugate_gradients(const Multigrid& M, MultiVector& X, const ConjugateGradientsOptions& options = {});

}  // namespace palpate::fem
