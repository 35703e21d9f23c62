#include "identify/loading/creep.h"

#include <cmath>

#include "identify/loading/contact_sum.h"

namespace palpate::identify {
namespace {

/// J(t) / J(0), t [s] after the load was put on.
double compliance(const fem::CreepLaw& creep, double t) { return 1 + creep.creep * (1 - std::exp(-t / creep.tau)); }

}  // namespace

std::vector<mesh::Contact> creep_equivalent_load(const std::vector<HeldLoad>& history, const fem::CreepLaw& creep) {
    std::vector<mesh::Contact> result;
    const double t = history.back().time;
    for (std::size_t i = 0; i < history.size(); ++i) {
        // on since the stage before, off again when the next one came
        const double on = compliance(creep, t - (i > 0 ? history[i - 1].time : 0));
        const double off = i + 1 < history.size() ? compliance(creep, t - history[i].time) : 0;
        for (const mesh::Contact& contact : history[i].contacts) add_contact(result, contact, on - off);
    }
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
