#pragma once

#include "skeleton/runtime/tools/tendons.h"
#include "skeleton/runtime/tools/tools.h"

namespace palpate::runtime {

/// What acts on a body stiffly, by where it is: rigid tools and cables.
struct Rig {
    Tools tools;
    Tendons tendons;

    explicit Rig(const skeleton::Model& model) : tools(model), tendons(model) {}
    bool any() const { return tools.any() || tendons.any(); }
    void add_forces(const double* pose, double* force) {
        if (tools.any()) tools.add_forces(pose, force);
        if (tendons.any()) tendons.add_forces(pose, force);
    }
    void add_rows(const double* pose, StiffRows& stiff) {
        if (tools.any()) tools.add_rows(pose, stiff);
        if (tendons.any()) tendons.add_rows(pose, stiff);
    }
};

}  // namespace palpate::runtime
