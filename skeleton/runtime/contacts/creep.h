#pragma once

#include <optional>
#include <vector>

#include "fem/effects/effects.h"
#include "skeleton/runtime/contacts/contacts.h"

namespace palpate::runtime {

/// Creep of a body under the forces of its contacts, as Boltzmann's superposition has it: it answers at once to what it
/// bears, f + c q, where q follows the force f as q' = (f - q) / tau. Under a force that is held that grows from f to
/// (1 + c) f; where one was taken away it fades. Over a step of h at whose end f is known, q comes exactly to
/// (1 - a) q + a f, a = 1 - exp(-h / tau).
class CreepIntegrator {
public:
    explicit CreepIntegrator(const std::optional<fem::CreepLaw>& creep) : creep_(creep) {}

    /// Tells contacts what is borne at the end of a step of h [s]; 0: at once. True when it is another share than
    /// before of the force of one.
    bool begin(double h, std::vector<ContactState>& contacts) const;
    /// The step has ended, with the contacts placed where it did.
    void end(double h, std::vector<ContactState>& contacts) const;
    /// A contact was let go: what is left of it fades.
    void release(ContactState& contact) const;

private:
    double share(double h) const;  // a

    std::optional<fem::CreepLaw> creep_;
};

}  // namespace palpate::runtime
