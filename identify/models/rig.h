#pragma once

#include <memory>
#include <vector>

#include "fem/effects/effects.h"
#include "fem/rig/tool_potential.h"
#include "mesh/core/actuator.h"
#include "mesh/core/tool.h"

namespace palpate::identify {

struct Action;

/// What may touch a body, and act within it.
struct Rig {
    std::vector<mesh::Tool> tools;
    std::vector<mesh::Actuator> actuators;
};

/// A rig made ready for all actions: the one place where they become effects in force.
class PreparedRig {
public:
    /// @throws InvalidInput as fem::RigidTool.
    explicit PreparedRig(const Rig& rig);

    /// Puts an action in force on a body of the Young's modulus `young` [MPa]; tendons rub as the effects there say.
    /// @pre no coordinate of its motions is free.
    void add(const Action& action, double young, fem::Effects& effects) const;
    /// One tool where it is.
    std::shared_ptr<const fem::ToolPotential> tool(const mesh::ToolMotion& motion, double young) const;
    /// What an actuator does: a pressure in a cavity, or the pull of a tendon; the other is empty.
    const std::shared_ptr<const mesh::PressureActuator>& cavity(int actuator) const { return cavities_[actuator]; }
    fem::TendonPull tendon(const mesh::ActuatorSetting& setting, double young, double friction) const;
    /// The same tendon by tension, where a pull of the rig's is by length; null: it is none of the rig's.
    std::shared_ptr<const mesh::TendonActuator> by_tension(const fem::TendonPull& pull) const;

    /// Does the rig make a body nonlinear whatever its law: by tools, which touch or part, or tendons, which go slack?
    bool is_nonlinear() const;

private:
    std::vector<std::shared_ptr<const fem::RigidTool>> tools_;
    std::vector<std::shared_ptr<const mesh::PressureActuator>> cavities_;  // of the actuators, null: it is a tendon
    std::vector<std::shared_ptr<const mesh::TendonActuator>> tendons_;     // of the actuators, null: it is a cavity
    std::vector<std::shared_ptr<const mesh::TendonActuator>> by_tension_;  // the same, all by tension
};

}  // namespace palpate::identify
