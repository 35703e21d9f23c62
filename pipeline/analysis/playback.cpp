#include "pipeline/analysis/playback.h"

#include <map>

#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "identify/loading/history/load_history.h"
#include "identify/loading/loads.h"
#include "identify/loading/readings.h"
#include "identify/loading/reduced_load.h"
#include "skeleton/model/observation.h"

namespace palpate::pipeline {
namespace {

std::vector<identify::ReducedLoadEquilibrium> play_rigged(const skeleton::Model& model,
                                                          const identify::MeasurementSet& set) {
    const identify::ContactLoads to_load(model);
    const std::vector<skeleton::Equilibrium> equilibria = identify::play_rigged(model, set, 1);
    std::vector<identify::ReducedLoadEquilibrium> played;
    played.reserve(equilibria.size());
    for (std::size_t s = 0; s < equilibria.size(); ++s)
        played.push_back({.equilibrium = equilibria[s], .load = to_load(set, set.states[s])});
    return played;
}

}  // namespace

std::vector<identify::ReducedLoadEquilibrium> play(const skeleton::Model& model, const identify::MeasurementSet& set) {
    if (identify::is_rigged(set)) return play_rigged(model, set);
    const std::vector<identify::StateReadings> read = identify::collect_readings(model, set);
    std::map<int, int> reading_of;  // of a state of the set, where it has one
    for (int r = 0; r < static_cast<int>(read.size()); ++r) reading_of[read[r].state] = r;

    skeleton::StaticsSolver solver(model);
    const identify::ContactLoads to_load(model);
    const Eigen::VectorXd k = skeleton::stiffness_vector(model);
    std::vector<skeleton::Equilibrium> so_far(read.size());
    std::vector<identify::ReducedLoadEquilibrium> played;
    for (int s = 0; s < static_cast<int>(set.states.size()); ++s) {
        const auto found = reading_of.find(s);
        if (found == reading_of.end()) {
            played.push_back(identify::solve_with_reduced_load(solver, k, to_load(set, set.states[s]), {}));
            continue;
        }
        const int r = found->second;
        const identify::LoadHistory before = identify::reduced_load_history_before(model, solver, k, read, r, so_far);
        played.push_back(identify::solve_with_reduced_load(solver, k, read[r].load, before.flowed));
        so_far[r] = played.back().equilibrium;
    }
    return played;
}

Points skin_displacement(const skeleton::Model& model, const skeleton::Equilibrium& equilibrium,
                         const skeleton::Load& load) {
    return skeleton::observed(model, equilibrium, load, model.skin) - model.surface.vertices;
}

}  // namespace palpate::pipeline
