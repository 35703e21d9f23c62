#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "mesh/core/actuator.h"

namespace palpate::fem {

/// Pressure in one of a body's cavities, above that outside.
struct CavityPressure {
    std::shared_ptr<const mesh::PressureActuator> actuator;
    double pressure = 0;  // [MPa]
};

/// What friction makes of a tendon's pull.
struct TendonFriction {
    Eigen::VectorXd shares;  // tension of each segment over that at the first point [-]
    double taken_up = 0;     // by length: what rubbing segments count too little, sum_k (1 - share_k) change_k [mm]
};

/// A tendon that pulls. It runs from a guide in space, its first point, to where it is fixed, its last, and rubs at
/// those between. By length it does not stretch, but for the thousandth that a body of the side L, its length, would:
/// so stiff a cable, 10^3 E L, is as good as rigid in any body.
struct TendonPull {
    std::shared_ptr<const mesh::TendonActuator> actuator;
    double value = 0;                  // tension [N], or the length drawn in [mm]
    double young = 0;                  // of the body [MPa], where it is by length
    double coefficient = 0;            // of friction [-]
    std::vector<double> earlier = {};  // values before, as mesh::ActuatorSetting has them
    /// Held while an equilibrium is sought, so that forces have a potential; none: as the path is.
    std::optional<TendonFriction> friction = std::nullopt;

    /// With a share of the pull.
    TendonPull part(double share) const;
};

/// What a tendon does: it is under tension, and as much shorter between its points as was drawn in.
struct TendonState {
    double tension = 0;   // [N]
    double drawn_in = 0;  // [mm]
};

}  // namespace palpate::fem
