#include "identify/effects/hiding.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/core/scaled_motion.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

/// Five digits: what is drawn might as well be short.
double rounded(double value) {
    return mesh::parse_number(fmt::format("{:.5g}", value)).value_or(value) + 0.0;  // which makes -0 a 0
}

}  // namespace

Points TrueConditions::see(const std::vector<Marker>& rest, const Points& markers) const {
    if (shift.isZero(0) && turn.isZero(0)) return markers;
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const Marker& marker : rest) centre += marker.rest.transpose();
    centre /= static_cast<double>(rest.size());
    const Mat3 R = skeleton::rotation(turn);
    return ((markers.rowwise() - centre) * R.transpose()).rowwise() + (centre + shift.transpose());
}

Action TrueConditions::act(Action action) const {
    for (mesh::ToolMotion& motion : action.motions) motion = mesh::scaled(motion, share);
    for (mesh::ActuatorSetting& setting : action.settings)
        if (setting.actuator == 0) setting.scale(actuator_gain);
    return action;
}

double TrueConditions::scatter(double noise) const {
    const double width = outlier_width * noise;
    return outlier_share * width * width;
}

double number_of(const skeleton::EffectRecord& record, const std::string& name) {
    return std::ranges::find(record.parameters, name, &skeleton::EffectParameter::name)->value;
}

bool SpecifiedNumbers::has(const std::string& name) const {
    return std::ranges::find(given_, name, &skeleton::EffectParameter::name) != given_.end();
}

bool SpecifiedNumbers::has_any(const std::vector<std::string>& names) const {
    return std::ranges::any_of(names, [&](const std::string& name) { return has(name); });
}

double SpecifiedNumbers::value(const std::string& name, double drawn) const {
    const auto record = std::ranges::find(given_, name, &skeleton::EffectParameter::name);
    return record == given_.end() ? drawn : record->value;
}

double SpecifiedNumbers::positive_value(const std::string& name, double drawn, double most) const {
    const double result = value(name, drawn);
    if (result > 0 && result <= most) return result;
    throw InvalidInput(fmt::format("effect '{}': {} is {:g}, allowed is above 0 to {:g}", effect_, name, result, most));
}

Vec3 SpecifiedNumbers::vector(const std::array<std::string, 3>& names, const Vec3& drawn) const {
    if (!has_any({names.begin(), names.end()})) return drawn;
    return {value(names[0], 0), value(names[1], 0), value(names[2], 0)};
}

skeleton::EffectRecord SpecifiedNumbers::effect(const std::vector<std::pair<std::string, double>>& drawn) const {
    skeleton::EffectRecord effect{effect_, {}};
    for (const skeleton::KnownParameter& known : known_) {
        const auto own = std::ranges::find(drawn, known.name, &std::pair<std::string, double>::first);
        if (has(known.name)) {
            effect.parameters.push_back({known.name, value(known.name, 0), known.unit});
        } else if (own != drawn.end()) {
            effect.parameters.push_back({known.name, rounded(own->second), known.unit});
        }
    }
    return effect;
}

Vec3 random_direction(RandomStream& random) {
    Vec3 direction;
    do {
        direction = random.normals(3);
    } while (direction.norm() < 1e-6);
    return direction.normalized();
}

}  // namespace palpate::identify
