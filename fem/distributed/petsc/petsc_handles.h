#pragma once

#include <petscksp.h>

#include <string>

namespace palpate::fem {

/// @throws SolverFailure with PETSc's words for an error code, and what was being done.
void check_petsc(PetscErrorCode code, const char* doing);

/// An object of PETSc's that is destroyed with its handle.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class PetscHandle {
public:
    PetscHandle() = default;
    ~PetscHandle() { destroy(&object_); }
    PetscHandle(const PetscHandle&) = delete;
    PetscHandle& operator=(const PetscHandle&) = delete;

    operator Object() const { return object_; }
    Object* operator&() { return &object_; }

private:
    Object object_ = nullptr;
};

using MatrixHandle = PetscHandle<Mat, MatDestroy>;
using VectorHandle = PetscHandle<Vec, VecDestroy>;
using SolverHandle = PetscHandle<KSP, KSPDestroy>;
using ScatterHandle = PetscHandle<VecScatter, VecScatterDestroy>;
using NullSpaceHandle = PetscHandle<MatNullSpace, MatNullSpaceDestroy>;

}  // namespace palpate::fem
