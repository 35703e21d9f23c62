#include <fmt/format.h>

#include <utility>

#include "identify/measurements/files/path_inside.h"
#include "identify/measurements/files/rig/rig_yaml.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::identify {
namespace {

using mesh::YamlFields;

mesh::PressureActuator read_pressure(const YamlFields& item, const SetUnits& units, const MeasurementSet& set,
                                     const std::string& name) {
    const YamlFields cavity = item.mapping("cavity");
    const bool is_near = cavity.has("near");
    if (is_near == cavity.has("surface"))
        throw InvalidInput(
            fmt::format("{}: a cavity is told by a point 'near' it, or by a 'surface' of its own; {} here.",
                        item.where("cavity"), is_near ? "both stand" : "neither stands"));
    mesh::PressureActuator actuator;
    if (is_near)
        actuator.cavity = Vec3(units.length * cavity.vector("near"));
    else
        actuator.cavity = read_closed_surface(cavity, "surface", set.folder, units.length,
                                              fmt::format("the chamber of actuator '{}'", name));
    cavity.finish();
    return actuator;
}

mesh::TendonActuator read_tendon(const YamlFields& item, const SetUnits& units) {
    const std::vector<Vec3> path = item.vectors("path");
    if (path.size() < 2)
        throw InvalidInput(
            fmt::format("{}: {} point stands here, a tendon runs through two at least; the last is where it is fixed.",
                        item.where("path"), path.size()));
    mesh::TendonActuator tendon;
    tendon.path.resize(std::ssize(path), 3);
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (i > 0 && path[i] == path[i - 1])
            throw InvalidInput(fmt::format("{}: points {} and {} are the same, [{}]. Give it once.", item.where("path"),
                                           i, i + 1, fmt::join(path[i], ", ")));
        tendon.path.row(static_cast<Eigen::Index>(i)) = units.length * path[i].transpose();
    }
    tendon.by_length = item.choice("by", {"tension", "length"}) == "length";
    return tendon;
}

mesh::Actuator read_actuator(const YamlFields& item, const SetUnits& units, const MeasurementSet& set) {
    std::vector<std::string> taken;
    for (const mesh::Actuator& other : set.actuators) taken.push_back(other.name);
    mesh::Actuator actuator{.name = read_own_name(item, taken), .kind = {}};
    if (item.choice("kind", {"pressure", "tendon"}) == "pressure")
        actuator.kind = read_pressure(item, units, set, actuator.name);
    else
        actuator.kind = read_tendon(item, units);
    item.finish();
    return actuator;
}

struct ActuatorToYaml {
    const std::filesystem::path& folder;
    int number;  // of the actuator, for its file

    std::string operator()(const mesh::PressureActuator& actuator) const {
        std::string cavity;
        if (const auto* near = std::get_if<Vec3>(&actuator.cavity)) {
            cavity = "near: " + yaml_list(*near);
        } else {
            const std::string file = fmt::format("cavity_{}.vtp", number);
            mesh::write_vtp(folder / file, std::get<mesh::Surface>(actuator.cavity));
            cavity = "surface: " + file;
        }
        return fmt::format("    kind: pressure\n    cavity: {{{}}}\n", cavity);
    }
    std::string operator()(const mesh::TendonActuator& tendon) const {
        std::string path;
        for (const auto& point : tendon.path.rowwise())
            path += (path.empty() ? "" : ", ") + yaml_list(point.transpose());
        return fmt::format("    kind: tendon\n    path: [{}]\n    by: {}\n", path,
                           tendon.by_length ? "length" : "tension");
    }
};

}  // namespace

void read_actuators(const YamlFields& yaml, const SetUnits& units, MeasurementSet& set) {
    if (!yaml.has("actuators")) return;
    for (const YamlFields& item : yaml.mappings("actuators")) set.actuators.push_back(read_actuator(item, units, set));
}

std::string actuators_to_yaml(const std::filesystem::path& folder, const std::vector<mesh::Actuator>& actuators) {
    std::string text = actuators.empty() ? "" : "actuators:\n";
    int number = 0;
    for (const mesh::Actuator& actuator : actuators) {
        text += fmt::format("  - name: {}\n", yaml_text(actuator.name));
        text += std::visit(ActuatorToYaml{folder, ++number}, actuator.kind);
    }
    return text;
}

}  // namespace palpate::identify
