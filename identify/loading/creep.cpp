#include "identify/loading/creep.h"

#include <cmath>

#include "identify/loading/contact_sum.h"

namespace palpate::identify {
namespace {

/// J(t) / J(0), t [s] after the load was put on.
double compliance(const fem::CreepLaw& creep, double t) { return 1 + creep.creep * (1 - std::exp(-t / creep.tau)); }

}  // namespace

std::vector<double> superposition_weights(const std::vector<double>& times, const fem::CreepLaw& creep) {
    std::vector<double> weights(times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double on = compliance(creep, times.back() - (i > 0 ? times[i - 1] : 0));
        const double off = i + 1 < times.size() ? compliance(creep, times.back() - times[i]) : 0;
        weights[i] = on - off;
    }
    return weights;
}

std::vector<mesh::Contact> creep_equivalent_load(const std::vector<HeldLoad>& history, const fem::CreepLaw& creep) {
    std::vector<double> times;
    times.reserve(history.size());
    for (const HeldLoad& stage : history) times.push_back(stage.time);
    const std::vector<double> weights = superposition_weights(times, creep);
    std::vector<mesh::Contact> result;
    for (std::size_t i = 0; i < history.size(); ++i)
        for (const mesh::Contact& contact : history[i].contacts) add_contact(result, contact, weights[i]);
    return result;
}

MeasurementSet as_elastic(const MeasurementSet& set, const fem::CreepLaw& creep) {
    MeasurementSet result = set;
    std::vector<HeldLoad> history;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        if (s > 0 && set.states[s].probe != set.states[s - 1].probe) history.clear();
        history.push_back({set.states[s].time, set.states[s].contacts});
        result.states[s].contacts = creep_equivalent_load(history, creep);
    }
    return result;
}

}  // namespace palpate::identify
