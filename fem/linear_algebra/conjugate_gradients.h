#pragma once

#include "fem/linear_algebra/multigrid/multigrid.h"

namespace palpate::fem {

struct ConjugateGradientsOptions {
    double tolerance = 1e-11;  // of the error's energy norm, as a share of the solution's, > 0; estimated
    int iterations = 500;      // at most, >= 1
};

/// X <- A^-1 X, with A the multigrid's matrix; all columns at once, each with its own steps. The energy norm of the
/// error is estimated as sqrt(r . M r) against that at the start, which is off by the root of the condition of M A at
/// most.
/// @return iterations. @throws SolverFailure with iterations and error when they do not suffice, and
/// where A is singular.
int conjugate_gradients(const Multigrid& M, MultiVector& X, const ConjugateGradientsOptions& options = {});

}  // namespace palpate::fem
