#include "skeleton/runtime/contacts/creep.h"

#include <cmath>

namespace palpate::runtime {

double CreepIntegrator::share(double h) const { return -std::expm1(-h / creep_->tau); }

bool CreepIntegrator::begin(double h, std::vector<ContactState>& contacts) const {
    if (!creep_) return false;
    const double a = share(h);
    bool changed = false;
    for (ContactState& contact : contacts) {
        const double gain = contact.creeps ? 1 + creep_->creep * a : 1;
        changed = changed || (contact.used && gain != contact.gain);
        contact.gain = gain;
        contact.crept = creep_->creep * (1 - a) * contact.lagged_force;
    }
    return changed;
}

void CreepIntegrator::end(double h, std::vector<ContactState>& contacts) const {
    if (!creep_) return;
    const double a = share(h);
    for (ContactState& contact : contacts) {
        if (!contact.acts() || !contact.creeps) continue;
        contact.lagged_force += a * (contact.force() - contact.lagged_force);
        if (!contact.used && contact.lagged_force.norm() <= contact.negligible_force) contact.lagged_force.setZero();
    }
}

void CreepIntegrator::release(ContactState& contact) const {
    constexpr double felt = 1e-6;
    contact.used = false;
    contact.mode = ContactState::Mode::nothing;
    contact.negligible_force = felt * contact.lagged_force.norm();
}

}  // namespace palpate::runtime
