#pragma once

#include <string>
#include <variant>
#include <vector>

#include "mesh/core/surface.h"
#include "mesh/types.h"

namespace palpate::mesh {

/// Pressure in the closed cavity nearest to a point, or in one that a surface describes.
struct PressureActuator {
    std::variant<Vec3, Surface> cavity;
};
/// A cable through the body along a path, straight between its points and fixed at the last one.
struct TendonActuator {
    Points path;             // (p x 3) [mm], at rest
    bool by_length = false;  // a value is the length drawn in [mm]; else the tension [N]
};

/// What acts on a body from inside, and is known.
struct Actuator {
    std::string name;
    std::variant<PressureActuator, TendonActuator> kind;
};

/// Is it a tendon that passes a point between its ends, where it may turn and rub?
inline bool may_rub(const Actuator& actuator) {
    const auto* tendon = std::get_if<TendonActuator>(&actuator.kind);
    return tendon && tendon->path.rows() > 2;
}

/// What an actuator is set to.
struct ActuatorSetting {
    int actuator = 0;  // index among the actuators
    double value = 0;  // pressure over that outside [MPa], tension [N], or length drawn in [mm]
    // What a tendon was set to before, from the largest value on, where that was more: on its way back it rubs the
    // other way.
    std::vector<double> earlier = {};

    void scale(double factor) {
        value *= factor;
        for (double& one : earlier) one *= factor;
    }
};

}  // namespace palpate::mesh
