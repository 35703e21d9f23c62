#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fem/large_deformation/material_law.h"

namespace palpate::pipeline {

/// A rig that moves the body or sets something within it, in place of probes that press with a force.
struct RigOptions {
    std::string tool{};                 // "sphere:radius=5" or "flat:radius=4" [mm]; empty: none
    std::vector<double> depth{};        // how far it is pressed in at each place, ascending [mm]
    std::vector<std::string> cavity{};  // "x,y,z": the closed cavity nearest to it; none: that nearest to the middle
    std::vector<double> pressure{};     // that each cavity is set to [MPa]
    std::vector<std::string> tendon{};  // "x,y,z x,y,z ...": a path through the body, fixed at its last point
    std::vector<double> tension{};      // that each tendon is pulled with [N]
    std::vector<double> pull{};         // or the length that is drawn in [mm]
    std::optional<double> reaction_noise{};  // 1 sigma [N], >= 0; absent: 2 % of the rms force where something is
                                             // hidden, else none
    bool markers = true;                     // are read beside the tool's force
    bool empty() const { return tool.empty() && pressure.empty() && tendon.empty(); }
    void validate() const;  // @throws InvalidInput naming option, value and what belongs to it
};

/// What a body goes through while it is probed, and what is wrong with it or with the readings; beside how many probes
/// there are and how far they press (ProbeOptions).
struct BlindSetOptions {
    std::vector<std::string> hide{};        // EFFECT[:name=value,...] each
    std::optional<fem::MaterialLaw> law{};  // absent: neo-Hookean, or what a skeleton has
    int levels = 0;                         // loads that each probe presses with, [0, 100]; 0: one, 1/3, 2/3, 1 in turn
    std::vector<double> dwell{};            // each held load is read so long after it was put on [s], > 0, ascending
    std::optional<bool> unload{};      // after each load the body is let go; absent: where a hidden effect needs it
    std::optional<bool> back{};        // each probe goes back through its loads; absent: likewise
    std::optional<bool> continuous{};  // one body goes through all probes; absent: likewise
    std::optional<double> noise{};     // 1 sigma [mm], >= 0; absent: 2 % of the rms displacement where something is
                                       // hidden, else none
    double missing = 0;                // share of the readings that are left out, [0, 0.9]
    double unlabelled = 0;             // share of the readings that do not tell their marker, [0, 1]
    RigOptions rig{};                  // in place of forces
    bool include_material = false;     // in the set, though something is hidden
    void validate() const;             // @throws InvalidInput naming option, value and bound
};

}  // namespace palpate::pipeline
