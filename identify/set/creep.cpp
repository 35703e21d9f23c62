#include "identify/set/creep.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

/// J(t) / J(0), t [s] after the load was put on.
double compliance(const fem::Creep& creep, double t) { return 1 + creep.creep * (1 - std::exp(-t / creep.tau)); }

}  // namespace

std::vector<mesh::Contact> crept_load(const std::vector<HeldLoad>& life, const fem::Creep& creep) {
    std::vector<mesh::Contact> result;
    const auto add = [&](const mesh::Contact& contact, double factor) {
        const auto there = std::ranges::find_if(result, [&](const mesh::Contact& other) {
            return other.point == contact.point && other.radius == contact.radius;
        });
        if (there == result.end()) {
            result.push_back(contact);
            result.back().force *= factor;
        } else {
            there->force += factor * contact.force;
        }
    };
    const double t = life.back().time;
    for (std::size_t i = 0; i < life.size(); ++i) {
        // on since the stage before, off again when the next one came
        const double on = compliance(creep, t - (i > 0 ? life[i - 1].time : 0));
        const double off = i + 1 < life.size() ? compliance(creep, t - life[i].time) : 0;
        for (const mesh::Contact& contact : life[i].contacts) add(contact, on - off);
    }
    return result;
}

MeasurementSet as_elastic(const MeasurementSet& set, const fem::Creep& creep) {
    MeasurementSet result = set;
    std::vector<HeldLoad> life;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        if (s > 0 && set.states[s].probe != set.states[s - 1].probe) life.clear();
        life.push_back({set.states[s].time, set.states[s].contacts});
        result.states[s].contacts = crept_load(life, creep);
    }
    return result;
}

}  // namespace palpate::identify
