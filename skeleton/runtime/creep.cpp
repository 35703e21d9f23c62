#include "skeleton/runtime/creep.h"

#include <cmath>

namespace palpate::runtime {

double Creep::share(double h) const { return -std::expm1(-h / creep_->tau); }

bool Creep::begin(double h, std::vector<Contact>& contacts) const {
    if (!creep_) return false;
    const double a = share(h);
    bool changed = false;
    for (Contact& contact : contacts) {
        const double gain = contact.creeps ? 1 + creep_->creep * a : 1;
        changed = changed || (contact.used && gain != contact.gain);
        contact.gain = gain;
        contact.crept = creep_->creep * (1 - a) * contact.late;
    }
    return changed;
}

void Creep::end(double h, std::vector<Contact>& contacts) const {
    if (!creep_) return;
    const double a = share(h);
    for (Contact& contact : contacts) {
        if (!contact.acts() || !contact.creeps) continue;
        contact.late += a * (contact.force() - contact.late);
        if (!contact.used && contact.late.norm() <= contact.forgotten) contact.late.setZero();
    }
}

void Creep::release(Contact& contact) const {
    constexpr double felt = 1e-6;
    contact.used = false;
    contact.does = Contact::Does::nothing;
    contact.forgotten = felt * contact.late.norm();
}

}  // namespace palpate::runtime
