#pragma once

#include <algorithm>
#include <vector>

#include "mesh/core/contact.h"

namespace palpate::identify {

/// Adds a contact, its force times a factor, to others: those at one place are one.
inline void add_contact(std::vector<mesh::Contact>& sum, const mesh::Contact& contact, double factor) {
    const auto there = std::ranges::find_if(sum, [&](const mesh::Contact& other) {
        return other.point == contact.point && other.radius == contact.radius;
    });
    if (there != sum.end()) {
        there->force += factor * contact.force;
        return;
    }
    sum.push_back(contact);
    sum.back().force *= factor;
}

}  // namespace palpate::identify
