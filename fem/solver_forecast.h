#pragma once

#include <string>
#include <vector>

#include "fem/solver.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// How the equations of a body will be solved, and what that takes.
struct SolverForecast {
    Solver solver = Solver::factor;  // what will be taken
    double gigabytes = 0;            // that it holds
    double allowed_gigabytes = 0;    // that it may take; more cannot be solved here
    double seconds_to_make = 0;      // on two cores
    double seconds_of_load = 0;      // the same
    std::string words;               // what, and why

    bool fits() const { return gigabytes <= allowed_gigabytes; }
};

/// What ElasticBody will choose for `loads` load cases of a body with `nodes` nodes, some of them held, told from
/// `sample`: the same body, in as many or in fewer nodes, and what of it is held (a flag per node). It orders the
/// sample's unknowns, and assembles nothing.
/// @throws SolverFailure when memory does not suffice for that.
SolverForecast forecast_solver(const mesh::VolumeMesh& sample, const std::vector<char>& held, double nodes, int loads,
                               Solver solver);

}  // namespace palpate::fem
