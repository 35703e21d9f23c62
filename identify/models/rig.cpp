#include "identify/models/rig.h"

#include <algorithm>

#include "identify/models/body_model.h"

namespace palpate::identify {

PreparedRig::PreparedRig(const Rig& rig) {
    tools_.reserve(rig.tools.size());
    for (const mesh::Tool& tool : rig.tools) tools_.push_back(std::make_shared<fem::RigidTool>(tool));
    for (const mesh::Actuator& actuator : rig.actuators) {
        const auto* pressure = std::get_if<mesh::PressureActuator>(&actuator.kind);
        const auto* tendon = std::get_if<mesh::TendonActuator>(&actuator.kind);
        cavities_.push_back(pressure ? std::make_shared<mesh::PressureActuator>(*pressure) : nullptr);
        tendons_.push_back(tendon ? std::make_shared<mesh::TendonActuator>(*tendon) : nullptr);
        by_tension_.push_back(tendon ? std::make_shared<mesh::TendonActuator>(mesh::TendonActuator{tendon->path, false})
                                     : nullptr);
    }
}

void PreparedRig::add(const Action& action, double young, fem::Effects& effects) const {
    for (const mesh::ToolMotion& motion : action.motions) effects.tools.push_back(tool(motion, young));
    std::vector<mesh::ActuatorSetting> all(tendons_.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k].actuator = static_cast<int>(k);
    for (const mesh::ActuatorSetting& setting : action.settings) all[setting.actuator] = setting;
    for (const mesh::ActuatorSetting& setting : all) {
        if (tendons_[setting.actuator]) {
            effects.tendons.push_back(tendon(setting, young, effects.tendon_friction));
        } else if (setting.value != 0) {
            effects.cavities.push_back({cavities_[setting.actuator], setting.value});
        }
    }
}

std::shared_ptr<const fem::ToolPotential> PreparedRig::tool(const mesh::ToolMotion& motion, double young) const {
    return std::make_shared<fem::ToolPotential>(tools_[motion.tool], motion, young);
}

fem::TendonPull PreparedRig::tendon(const mesh::ActuatorSetting& setting, double young, double friction) const {
    return {tendons_[setting.actuator], setting.value, young, friction, setting.earlier};
}

std::shared_ptr<const mesh::TendonActuator> PreparedRig::by_tension(const fem::TendonPull& pull) const {
    const auto own = std::ranges::find(tendons_, pull.actuator);
    return own == tendons_.end() ? nullptr : by_tension_[own - tendons_.begin()];
}

bool PreparedRig::is_nonlinear() const {
    return !tools_.empty() || std::ranges::any_of(tendons_, [](const auto& one) { return one && one->by_length; });
}

}  // namespace palpate::identify
