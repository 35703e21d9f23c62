// Of a program that is built without PETSc.

#include <fmt/format.h>

#include <cstdlib>

#include "fem/distributed/distributed_stiffness.h"
#include "fem/distributed/processes.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

constexpr const char* how_to_build =
    "this palpate was built without PETSc: install petsc-dev and libmetis-dev, and configure with -DPALPATE_PETSC=ON";

/// How many processes mpirun of Open MPI, MPICH or Slurm started.
int started() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
        const char* const value = std::getenv(name);
        if (value) return std::atoi(value);
    }
    return 1;
}

[[noreturn]] void refuse() {
    throw InvalidInput(fmt::format("solver petsc: {}; allowed here: automatic, factor, multigrid", how_to_build));
}

}  // namespace

Processes::Processes() {
    if (started() > 1)
        throw InvalidInput(
            fmt::format("mpirun started {} processes, each of which would do the same work: {}; or start one",
                        started(), how_to_build));
}
Processes::~Processes() = default;
bool Processes::lead() const { return true; }
void Processes::serve() {}
int Processes::count() { return 1; }

struct DistributedStiffness::Impl {
    std::vector<int> number;
};

DistributedStiffness::DistributedStiffness(const mesh::VolumeMesh& /*mesh*/, const Materials& /*materials*/,
                                           Dilatation /*dilatation*/, const std::vector<char>& /*held*/) {
    refuse();
}
DistributedStiffness::DistributedStiffness(const BlockMatrix<3, 3>& /*K*/, const Points& /*positions*/) { refuse(); }
DistributedStiffness::~DistributedStiffness() = default;
const std::vector<int>& DistributedStiffness::number() const { return impl_->number; }
int DistributedStiffness::solve(MultiVector& /*X*/, const ConjugateGradientsOptions& /*options*/) { return 0; }
std::string DistributedStiffness::description() const { return {}; }

}  // namespace palpate::fem
