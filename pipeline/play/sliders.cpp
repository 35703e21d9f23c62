#include "pipeline/play/sliders.h"

#include <algorithm>
#include <optional>

#include "pipeline/output/actuator_unit.h"
#include "pipeline/play/touch/set_text.h"
#include "skeleton/loads/cavity_walls.h"

namespace palpate::pipeline {
namespace {

/// The same actuator, its cavity told by a point of the wall; none where the skin encloses no cavity.
std::optional<mesh::Actuator> by_point(const mesh::Actuator& actuator, const skeleton::Model& model) {
    const auto* pressure = std::get_if<mesh::PressureActuator>(&actuator.kind);
    if (!pressure) return actuator;
    const std::vector<skeleton::CavityWall> cavities = skeleton::walls_by_cavity(model);
    const int own = skeleton::find_cavity(model, cavities, *pressure);
    if (own < 0) return std::nullopt;
    const int corner = cavities[own].front().front();
    return mesh::Actuator{actuator.name, mesh::PressureActuator{Vec3(model.surface.vertices.row(corner))}};
}

}  // namespace

nlohmann::json actuator_sliders(const identify::MeasurementSet& set, const skeleton::Model& model,
                                std::vector<std::string>& notes) {
    constexpr double beyond = 1.5;
    nlohmann::json result = nlohmann::json::array();
    for (int a = 0; a < std::ssize(set.actuators); ++a) {
        double low = 0, high = 0;
        for (const identify::LoadState& state : set.states) {
            for (const identify::Actuation& one : state.actuations) {
                if (one.actuator != a) continue;
                low = std::min(low, beyond * one.value);
                high = std::max(high, beyond * one.value);
            }
        }
        const std::optional<mesh::Actuator> played = by_point(set.actuators[a], model);
        if (!played) notes.push_back(set.actuators[a].name + " is not played: the model's skin encloses no cavity.");
        result.push_back(played && high > low ? actuator_as_text(*played) : nlohmann::json());
        if (!result.back().is_null())
            result.back().update({{"low", low}, {"high", high}, {"unit", unit_of(set.actuators[a])}});
    }
    return result;
}

}  // namespace palpate::pipeline
