#pragma once

namespace palpate::fem {

/// What solves a body's linear equations: a factor where memory holds it and the loads are worth it, else conjugate
/// gradients, with multigrid or, on several processes, by PETSc; or always one of these.
enum class Solver { automatic, factor, multigrid, petsc };

}  // namespace palpate::fem
