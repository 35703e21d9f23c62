#include "pipeline/analysis/cost/cost.h"

#include <algorithm>
#include <cmath>

namespace palpate::pipeline {
namespace {

// Rates of one thread, fitted to runs like those of tests/bench/cost/RESULTS.md.
constexpr double program_gigabytes = 0.065;

/// Of a stage of which a share is parallel [Amdahl 1967]. Shares: of one run each on one and on two threads.
double on_threads(double seconds, double share, int threads) { return seconds * (1 - share + share / threads); }

/// Forecasts of solvers are for two cores.
double to_solve(const fem::SolverForecast& solver, double loads, int threads) {
    return (solver.seconds_to_make + loads * solver.seconds_of_load) * (threads > 1 ? 2.0 / threads : 2.0);
}

/// The body, and, where it was probed, its displacements in each state.
double gigabytes_of_fields(const WorkSize& size) {
    constexpr double a_node = 2e-6, a_node_and_state = 2.4e-8;
    return size.nodes * (a_node + (size.is_simulated ? a_node_and_state * size.states : 0));
}

StageCost meshing(const WorkSize& size, double speed) {
    constexpr double a_tetrahedron = 1.1e-5, gigabytes_of_one = 5e-7;
    const double more = std::max(0.0, size.tetrahedra - size.sample_tetrahedra);
    const double seconds = size.seconds_to_mesh + a_tetrahedron * more / speed;
    return {"mesh", seconds, seconds, program_gigabytes + gigabytes_of_one * size.tetrahedra};
}

/// On one thread, whatever there are.
StageCost building(const WorkSize& size) {
    constexpr double a_run = 0.2, a_node_and_sphere = 1.5e-6, two_spheres = 2e-5;
    const double seconds = a_run + a_node_and_sphere * size.skeleton_nodes * size.spheres +
                           two_spheres * size.spheres * size.spheres + to_solve(size.condensed, 0, 1);
    constexpr double gigabytes_of_node_and_sphere = 1.5e-7, of_two_spheres = 3e-6;
    return {"skeleton", seconds, seconds,
            2 * program_gigabytes + size.condensed.gigabytes +
                gigabytes_of_node_and_sphere * size.skeleton_nodes * size.spheres +
                of_two_spheres * size.spheres * size.spheres,
            size.condensed.words};
}

StageCost probing(const WorkSize& size, int threads) {
    // The second mesh, with edges half as long again, has about 0.4 of the nodes, and the square of that to factor.
    constexpr double with_second_mesh = 1.2, a_run = 0.2, a_node_and_state = 1.9e-6, share = 0.4;
    const double seconds = a_run + with_second_mesh * to_solve(size.probed, size.states, threads) +
                           on_threads(a_node_and_state * size.nodes * size.states, share, threads);
    return {"measurements", seconds, seconds, program_gigabytes + size.probed.gigabytes + gigabytes_of_fields(size),
            size.probed.words};
}

StageCost identifying(const WorkSize& size, int threads) {
    // A power of each size; there is no theory behind them.
    constexpr double share = 0.95;
    const double seconds =
        on_threads(2e-3 * std::pow(size.parameters, 0.23) * std::pow(size.fitted, 1.2) * std::pow(size.markers, 0.58),
                   share, threads);
    constexpr double gigabytes_of_slope = 8e-9;  // of a reading by a parameter
    return {"identify", seconds, seconds,
            2 * program_gigabytes + gigabytes_of_fields(size) +
                gigabytes_of_slope * size.parameters * size.fitted * size.markers};
}

StageCost comparing(const WorkSize& size) {
    // Of measurements only markers are compared.
    constexpr double of_markers = 0.1, a_run = 0.6, a_vertex_and_state = 4.2e-5, a_link_and_state = 1.1e-4;
    const double whole = a_run + size.states * (a_vertex_and_state * size.skin + a_link_and_state * size.links);
    const double seconds = size.is_simulated ? whole : of_markers;
    constexpr double a_vertex_and_sphere = 2.8e-7;
    return {"compare", seconds, seconds,
            2 * program_gigabytes + gigabytes_of_fields(size) + a_vertex_and_sphere * size.skin * size.spheres};
}

/// What a diagnosis takes depends on what it finds: nothing is soon said.
StageCost diagnosing(const WorkSize& size, int threads) {
    constexpr double a_node_and_state = 1.4e-3, most = 2.5, share = 0.85, gigabytes_of_node_and_state = 8e-6;
    const double seconds = on_threads(a_node_and_state * size.reference_nodes * size.loaded, share, threads);
    return {"diagnose", seconds, most * seconds,
            3 * program_gigabytes + gigabytes_of_node_and_state * size.reference_nodes * size.loaded};
}

StageCost improving(const WorkSize& size, int threads) {
    StageCost cost = diagnosing(size, threads);
    constexpr double of_diagnosis = 0.6;
    cost.stage = "improve";
    cost.seconds *= of_diagnosis;
    cost.most_seconds *= of_diagnosis;
    return cost;
}

}  // namespace

std::vector<StageCost> cost_of_run(const WorkSize& size, int threads, double speed) {
    std::vector<StageCost> stages;
    stages.push_back(building(size));
    if (size.is_simulated) stages.push_back(probing(size, threads));
    stages.push_back(identifying(size, threads));
    stages.push_back(comparing(size));
    if (size.reference_nodes > 0) {
        stages.push_back(diagnosing(size, threads));
        stages.push_back(improving(size, threads));
    }
    // What a stage has freed is not all given back at once.
    constexpr double kept = 0.6;
    double before = 0;
    for (StageCost& one : stages) {
        one.gigabytes = std::max(one.gigabytes, kept * before);
        before = std::max(before, one.gigabytes);
        one.seconds /= speed;
        one.most_seconds /= speed;
    }
    stages.insert(stages.begin(), meshing(size, speed));
    return stages;
}

}  // namespace palpate::pipeline
