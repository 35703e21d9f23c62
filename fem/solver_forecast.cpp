#include "fem/solver_forecast.h"

#include <fmt/format.h>

#include <algorithm>

#include "fem/distributed/processes.h"
#include "fem/elements/assembly.h"
#include "fem/linear_algebra/cholesky/supernodes.h"
#include "fem/linear_algebra/solver_choice.h"

namespace palpate::fem {
namespace {

// Rates below are measured: tests/bench/fem/RESULTS.md.

/// A sample's factor, from the order of its unknowns.
FactorCost factor_of(const mesh::VolumeMesh& sample, const std::vector<char>& held) {
    std::vector<int> number(held.size());
    int count = 0;
    for (std::size_t i = 0; i < held.size(); ++i) number[i] = held[i] ? -1 : count++;
    const auto lower = neighbours(sample, number, Half::lower);
    return cost_of_factor(analyse(lower, 3).supernodes, lower);
}

}  // namespace

SolverForecast forecast_solver(const mesh::VolumeMesh& sample, const std::vector<char>& held, double nodes, int loads,
                               Solver solver) {
    FactorCost cost = factor_of(sample, held);
    cost = cost.with_nodes(cost.nodes * nodes / static_cast<double>(sample.nodes.rows()));
    const double allowed = usable_memory(), needed = cost.gigabytes();
    const std::string factor = fmt::format("a factor of {:.3g} GB", needed);
    std::string why;
    const bool is_chosen = solver != Solver::automatic;
    if (is_chosen) {
        why = "as was asked for";
    } else if (needed > allowed) {
        why = fmt::format("{} would not fit into {:.3g} GB", factor, allowed);
    } else if (is_faster_without_factor(cost, loads)) {
        why = fmt::format("{} would take longer", factor);
    } else {
        solver = Solver::factor;
    }
    if (solver == Solver::automatic) solver = Processes::count() > 1 ? Solver::petsc : Solver::multigrid;

    SolverForecast forecast;
    forecast.solver = solver;
    forecast.allowed_gigabytes = allowed;
    if (solver == Solver::factor) {
        constexpr double load_on_an_entry = 2.6e-11;  // [s], of two cores: 0.014 s at 100k-quadratic
        forecast.gigabytes = needed;
        forecast.seconds_to_make = cost.seconds();
        forecast.seconds_of_load = load_on_an_entry * cost.entries;
        forecast.words = factor;
    } else {
        // PETSc's takes 8 times as long to make on one process, and 27 times as long a load.
        const bool is_ours = solver == Solver::multigrid;
        forecast.gigabytes = multigrid_gigabytes(cost.nodes);
        forecast.seconds_to_make = seconds_without_factor(cost.nodes, 0) * (is_ours ? 1 : 8.0 / Processes::count());
        forecast.seconds_of_load = (seconds_without_factor(cost.nodes, 1) - seconds_without_factor(cost.nodes, 0)) *
                                   (is_ours ? 1 : 27.0 / Processes::count());
        forecast.words = fmt::format("conjugate gradients with {}, {:.3g} GB",
                                     is_ours ? "multigrid" : "PETSc's multigrid", forecast.gigabytes);
    }
    if (!why.empty()) forecast.words += " (" + why + ")";
    return forecast;
}

}  // namespace palpate::fem
