#include "pipeline/output/text/describe/describe_rig.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "identify/loading/loads.h"
#include "identify/measurements/rig/cavities.h"
#include "identify/measurements/rig/fittable.h"
#include "pipeline/output/actuator_unit.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// "1 motion", "2 motions"
std::string counted(int count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

/// What a tool did in a set.
struct ToolUse {
    int states = 0;                  // in which it touched
    std::vector<std::string> free;   // coordinates that were left free in some
    int readings = 0;                // of its reaction
    std::vector<std::string> reads;  // components that some of them read
};

/// Names of components that `is_there` holds for, of two vectors of three.
template <class IsThere>
void add_names(const char* const (&names)[6], IsThere is_there, std::vector<std::string>& into) {
    for (int c = 0; c < 6; ++c)
        if (is_there(c) && std::ranges::find(into, names[c]) == into.end()) into.emplace_back(names[c]);
}

ToolUse use_of(const identify::MeasurementSet& set, int tool) {
    constexpr const char* coordinates[6] = {"x", "y", "z", "rx", "ry", "rz"};
    constexpr const char* components[6] = {"fx", "fy", "fz", "mx", "my", "mz"};
    ToolUse use;
    for (const identify::LoadState& state : set.states) {
        for (const mesh::ToolMotion& motion : state.motions) {
            if (motion.tool != tool) continue;
            ++use.states;
            add_names(
                coordinates, [&](int c) { return std::isnan(c < 3 ? motion.translation[c] : motion.rotation[c - 3]); },
                use.free);
        }
        for (const identify::ReactionReading& reading : state.reactions) {
            if (reading.tool != tool) continue;
            ++use.readings;
            add_names(
                components, [&](int c) { return !std::isnan(c < 3 ? reading.force[c] : reading.moment[c - 3]); },
                use.reads);
        }
    }
    return use;
}

struct ShapeInWords {
    const mesh::Tool& tool;

    std::string at() const {
        return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", tool.origin.x(), tool.origin.y(), tool.origin.z());
    }
    std::string operator()(const mesh::SphereShape& sphere) const {
        return fmt::format("a sphere of radius {:.4g} mm, at rest at {}", sphere.radius, at());
    }
    std::string operator()(const mesh::FlatShape& flat) const {
        return fmt::format("a flat punch of radius {:.4g} mm along ({:.3g}, {:.3g}, {:.3g}), at rest at {}",
                           flat.radius, flat.axis.x(), flat.axis.y(), flat.axis.z(), at());
    }
    std::string operator()(const mesh::SurfaceShape& body) const {
        return fmt::format("a body of {} triangles about {}", body.surface.triangles.rows(), at());
    }
    std::string operator()(const mesh::GripShape& grip) const {
        return fmt::format("a grip of {} about {}", counted(static_cast<int>(grip.regions.size()), "region"), at());
    }
};

std::string tool_in_words(const identify::MeasurementSet& set, int number) {
    const mesh::Tool& tool = set.tools[static_cast<std::size_t>(number)];
    const ToolUse use = use_of(set, number);
    std::string text = fmt::format("tool '{}': {}, {}; {}", tool.name, std::visit(ShapeInWords{tool}, tool.shape),
                                   tool.bonded ? "bonded" : "frictionless", counted(use.states, "motion"));
    if (!use.free.empty()) text += fmt::format(" (free in some: {})", fmt::join(use.free, ", "));
    return text + (use.readings > 0 ? fmt::format("; {} of its reaction, of {}", counted(use.readings, "reading"),
                                                  fmt::join(use.reads, ", "))
                                    : "; its reaction is not read");
}

/// What an actuator was set to in a set.
struct ActuatorUse {
    int states = 0;
    double least = 0, most = 0;
};

ActuatorUse actuation_of(const identify::MeasurementSet& set, int actuator) {
    ActuatorUse use;
    for (const identify::LoadState& state : set.states)
        for (const identify::Actuation& actuation : state.actuations) {
            if (actuation.actuator != actuator) continue;
            use.least = use.states == 0 ? actuation.value : std::min(use.least, actuation.value);
            use.most = use.states == 0 ? actuation.value : std::max(use.most, actuation.value);
            ++use.states;
        }
    return use;
}

double path_length(const Points& path) {
    double length = 0;
    for (Eigen::Index i = 1; i < path.rows(); ++i) length += (path.row(i) - path.row(i - 1)).norm();
    return length;
}

struct ActuatorInWords {
    const identify::MeasurementSet& set;
    const std::string& name;

    std::string operator()(const mesh::PressureActuator& actuator) const {
        const auto* near = std::get_if<Vec3>(&actuator.cavity);
        const double volume = near ? identify::nearest_cavity(set.rest_surface, *near, name).volume
                                   : mesh::signed_volume(std::get<mesh::Surface>(actuator.cavity));
        return fmt::format("pressure in a cavity of {:.4g} mm^3", std::abs(volume));
    }
    std::string operator()(const mesh::TendonActuator& tendon) const {
        return fmt::format("a tendon through {} points, {:.4g} mm long, by {}", tendon.path.rows(),
                           path_length(tendon.path), tendon.by_length ? "length" : "tension");
    }
};

std::string actuator_in_words(const identify::MeasurementSet& set, int number) {
    const mesh::Actuator& actuator = set.actuators[static_cast<std::size_t>(number)];
    const ActuatorUse use = actuation_of(set, number);
    std::string text =
        fmt::format("actuator '{}': {}; {}", actuator.name,
                    std::visit(ActuatorInWords{set, actuator.name}, actuator.kind), counted(use.states, "actuation"));
    if (use.states == 1) text += fmt::format(", {:.4g} {}", use.most, unit_of(actuator));
    if (use.states > 1) text += fmt::format(" from {:.4g} to {:.4g} {}", use.least, use.most, unit_of(actuator));
    return text;
}

int count_of_displacements(const identify::MeasurementSet& set) {
    int count = 0;
    for (const identify::LoadState& state : set.states)
        count += static_cast<int>(
            std::ranges::count_if(state.readings, [](const identify::Reading& r) { return r.since.has_value(); }));
    return count;
}

}  // namespace

std::size_t loaded_states(const identify::MeasurementSet& set) {
    return static_cast<std::size_t>(std::ranges::count_if(set.states, [](const identify::LoadState& state) {
        return !state.contacts.empty() || std::ranges::any_of(state.motions, identify::is_off_rest) ||
               std::ranges::any_of(state.actuations, [](const identify::Actuation& a) { return a.value != 0; });
    }));
}

std::vector<std::string> rig_in_words(const identify::MeasurementSet& set) {
    std::vector<std::string> lines;
    lines.reserve(set.tools.size() + set.actuators.size());
    for (int t = 0; t < static_cast<int>(set.tools.size()); ++t) lines.push_back(tool_in_words(set, t));
    for (int a = 0; a < static_cast<int>(set.actuators.size()); ++a) lines.push_back(actuator_in_words(set, a));
    if (const int count = count_of_displacements(set); count > 0)
        lines.push_back(fmt::format("{} of the readings are displacements since another state", count));
    if (!lines.empty() && !identify::tells_a_force(set))
        lines.emplace_back(
            "no force is measured: stiffness is identified up to a common factor, only its ratios are determined");
    if (set.reaction_noise) lines.push_back(fmt::format("noise of reactions {:.3g} N (1 sigma)", *set.reaction_noise));
    if (set.moment_noise) lines.push_back(fmt::format("noise of moments {:.3g} N*mm (1 sigma)", *set.moment_noise));
    const std::vector<identify::UnfittedPart> parts = identify::parts_not_fitted_yet(set);
    if (!parts.empty()) lines.push_back("cannot be fitted yet: " + identify::in_words(parts));
    return lines;
}

json rig_json(const identify::MeasurementSet& set) {
    json tools = json::array(), actuators = json::array();
    for (int t = 0; t < static_cast<int>(set.tools.size()); ++t) {
        constexpr const char* kinds[] = {"sphere", "flat", "mesh", "grip"};  // in the order of the variant
        const mesh::Tool& tool = set.tools[static_cast<std::size_t>(t)];
        const ToolUse use = use_of(set, t);
        tools.push_back({{"name", tool.name},
                         {"kind", kinds[tool.shape.index()]},
                         {"contact", tool.bonded ? "bonded" : "frictionless"},
                         {"origin", {tool.origin.x(), tool.origin.y(), tool.origin.z()}},
                         {"motions", use.states},
                         {"free", use.free},
                         {"reactions", use.readings},
                         {"reads", use.reads}});
    }
    for (int a = 0; a < static_cast<int>(set.actuators.size()); ++a) {
        const mesh::Actuator& actuator = set.actuators[static_cast<std::size_t>(a)];
        const ActuatorUse use = actuation_of(set, a);
        actuators.push_back({{"name", actuator.name},
                             {"kind", actuator.kind.index() == 0 ? "pressure" : "tendon"},
                             {"actuations", use.states},
                             {"least", use.least},
                             {"most", use.most},
                             {"unit", unit_of(actuator)}});
    }
    json not_fitted = json::array();
    for (const identify::UnfittedPart& part : identify::parts_not_fitted_yet(set)) not_fitted.push_back(part.what);
    return {{"tools", tools},
            {"actuators", actuators},
            {"displacements", count_of_displacements(set)},
            {"tells_a_force", identify::tells_a_force(set)},
            {"not_fitted_yet", not_fitted}};
}

}  // namespace palpate::pipeline
