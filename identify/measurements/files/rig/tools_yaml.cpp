#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "identify/measurements/files/path_inside.h"
#include "identify/measurements/files/rig/rig_yaml.h"
#include "identify/measurements/rig/rig_places.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/supports/region_yaml.h"

namespace palpate::identify {
namespace {

using mesh::YamlFields;

constexpr double least_radius = 1e-9, largest_radius = 1e12;  // [unit of the file]

/// The smallest box round the regions; a plane has none: there it is that of the surface's vertices within.
mesh::Box box_around(const std::vector<mesh::Region>& regions, const mesh::Surface& surface, const YamlFields& item) {
    std::vector<Vec3> corners;
    for (const mesh::Region& region : regions) {
        if (const auto* box = std::get_if<mesh::BoxRegion>(&region)) {
            corners.insert(corners.end(), {box->min, box->max});
        } else if (const auto* sphere = std::get_if<mesh::SphereRegion>(&region)) {
            const Vec3 reach = Vec3::Constant(sphere->radius);
            corners.insert(corners.end(), {sphere->center - reach, sphere->center + reach});
        } else if (const auto* points = std::get_if<mesh::PointsRegion>(&region)) {
            for (const auto& point : points->points.rowwise()) corners.emplace_back(point.transpose());
        } else {
            for (const auto& vertex : surface.vertices.rowwise())
                if (mesh::contains(region, vertex.transpose())) corners.emplace_back(vertex.transpose());
        }
    }
    if (corners.empty())
        throw InvalidInput(
            fmt::format("{}: the region holds no vertex of the rest surface, so nothing is gripped. Give it the unit "
                        "and the frame of the body.",
                        item.where("region")));
    mesh::Box box{corners.front(), corners.front()};
    for (const Vec3& corner : corners) {
        box.min = box.min.cwiseMin(corner);
        box.max = box.max.cwiseMax(corner);
    }
    return box;
}

void read_grip(const YamlFields& item, const SetUnits& units, const MeasurementSet& set, mesh::Tool& tool) {
    const std::vector<YamlFields> items = item.mapping_or_mappings("region");
    check_region_paths(items, set.folder);
    mesh::GripShape grip;
    for (const YamlFields& region : items) grip.regions.push_back(mesh::read_region(region, units.length));
    if (grip.regions.empty())
        throw InvalidInput(
            fmt::format("{}: the list is empty; a grip holds the material in a box, sphere, plane or points",
                        item.where("region")));
    if (item.has("contact") && item.choice("contact", {"bonded", "frictionless"}) == "frictionless")
        throw InvalidInput(
            fmt::format("{}: a grip holds its material, and 'frictionless' lets it go. Say 'bonded', or describe what "
                        "touches the body by a 'shape'.",
                        item.where("contact")));
    tool.bonded = true;
    if (item.has("origin")) {
        tool.origin = units.length * item.vector("origin");
    } else {
        const mesh::Box box = box_around(grip.regions, set.rest_surface, item);
        tool.origin = (box.min + box.max) / 2;
    }
    tool.shape = std::move(grip);
}

/// Where the centre of a ball or disc is at rest.
void read_place(const YamlFields& item, const SetUnits& units, mesh::Tool& tool, std::vector<std::string>& notes) {
    if (item.has("at")) {
        tool.origin = units.length * item.vector("at");
        return;
    }
    notes.push_back(
        fmt::format("Tool '{}' has no 'at': its centre rests at the origin of the set's frame, so motions.csv tells "
                    "where its centre is.",
                    tool.name));
}

/// A punch stands flat on the body: it presses against the mean normal of the surface before it.
Vec3 read_axis(const YamlFields& item, double radius, const MeasurementSet& set, const mesh::Tool& tool,
               std::vector<std::string>& notes) {
    if (item.has("axis")) {
        const Vec3 axis = item.vector("axis");
        if (axis.norm() == 0)
            throw InvalidInput(fmt::format(
                "{}: an axis of length 0 has no direction; give one, from the tool into the body", item.where("axis")));
        return axis.normalized();
    }
    Vec3 axis(0, 0, -1);
    if (item.has("at")) {
        const Vec3 nearest = mesh::SurfaceTree(set.rest_surface).closest(tool.origin).position;
        const Vec3 normal = mesh::mean_normal(set.rest_surface, nearest, radius);
        if (normal.allFinite() && normal.norm() > 0) axis = (Vec3::Zero() - normal).normalized();
    }
    notes.push_back(fmt::format("Tool '{}' has no 'axis': it presses along ({:.3g}, {:.3g}, {:.3g}), {}.", tool.name,
                                axis.x(), axis.y(), axis.z(),
                                item.has("at") ? "square to the surface before it" : "for want of an 'at'"));
    return axis;
}

void read_shape(const YamlFields& item, const SetUnits& units, MeasurementSet& set, mesh::Tool& tool) {
    const YamlFields shape = item.mapping("shape");
    const int kinds = shape.has("sphere") + shape.has("flat") + shape.has("mesh");
    shape.finish();
    if (kinds != 1)
        throw InvalidInput(
            fmt::format("{}: {} kinds of shape stand here, one is needed: sphere: {{radius}}, flat: {{radius}} or "
                        "mesh: FILE.",
                        item.where("shape"), kinds));
    tool.bonded = item.choice("contact", {"bonded", "frictionless"}) == "bonded";
    if (shape.has("mesh")) {
        mesh::SurfaceShape body{
            read_closed_surface(shape, "mesh", set.folder, units.length, fmt::format("the tool '{}'", tool.name))};
        const mesh::Box box = mesh::bounding_box(body.surface.vertices);
        tool.origin = item.has("origin") ? Vec3(units.length * item.vector("origin")) : Vec3((box.min + box.max) / 2);
        tool.shape = std::move(body);
        return;
    }
    const YamlFields round = shape.mapping(shape.has("sphere") ? "sphere" : "flat");
    const double radius = units.length * round.number("radius", least_radius, largest_radius);
    round.finish();
    read_place(item, units, tool, set.notes);
    if (shape.has("sphere"))
        tool.shape = mesh::SphereShape{radius};
    else
        tool.shape = mesh::FlatShape{radius, read_axis(item, radius, set, tool, set.notes)};
}

mesh::Tool read_tool(const YamlFields& item, const SetUnits& units, MeasurementSet& set) {
    std::vector<std::string> taken;
    for (const mesh::Tool& other : set.tools) taken.push_back(other.name);
    mesh::Tool tool{.name = read_own_name(item, taken), .shape = {}};
    if (item.has("shape") == item.has("region"))
        throw InvalidInput(
            fmt::format("{}: the tool '{}' has {}. A tool has a 'shape', of what touches the body, or a 'region', of "
                        "the material that it grips.",
                        item.where("name"), tool.name, item.has("shape") ? "both" : "neither"));
    if (item.has("region"))
        read_grip(item, units, set, tool);
    else
        read_shape(item, units, set, tool);
    // without an 'at' the place at rest is not where the tool ever was
    if (item.has("at") || std::holds_alternative<mesh::SurfaceShape>(tool.shape))
        check_starts_outside(tool, set.rest_surface, item.where("name"));
    item.finish();
    return tool;
}

/// Shape and place of a tool in set.yaml.
class ShapeToYaml {
public:
    /// @param number of the tool, for its files
    ShapeToYaml(const std::filesystem::path& folder, const mesh::Tool& tool, int number)
        : folder_(folder), tool_(tool), number_(number) {}

    std::string operator()(const mesh::SphereShape& sphere) const {
        return fmt::format("    shape: {{sphere: {{radius: {}}}}}\n{}", sphere.radius, place());
    }
    std::string operator()(const mesh::FlatShape& flat) const {
        return fmt::format("    shape: {{flat: {{radius: {}}}}}\n{}    axis: {}\n", flat.radius, place(),
                           yaml_list(flat.axis));
    }
    std::string operator()(const mesh::SurfaceShape& body) const {
        const std::string file = fmt::format("tool_{}.vtp", number_);
        mesh::write_vtp(folder_ / file, body.surface);
        return fmt::format("    shape: {{mesh: {}}}\n    origin: {}\n", file, yaml_list(tool_.origin));
    }
    std::string operator()(const mesh::GripShape& grip) const {
        return fmt::format("    region:\n{}    origin: {}\n",
                           mesh::regions_to_yaml_in(folder_, grip.regions, fmt::format("tool_{}", number_), "      "),
                           yaml_list(tool_.origin));
    }

private:
    /// The origin of the frame is where a tool without a place rests, too.
    std::string place() const {
        return tool_.origin.isZero(0) ? "" : fmt::format("    at: {}\n", yaml_list(tool_.origin));
    }

    const std::filesystem::path& folder_;
    const mesh::Tool& tool_;
    int number_;
};

}  // namespace

void read_tools(const YamlFields& yaml, const SetUnits& units, MeasurementSet& set) {
    if (!yaml.has("tools")) return;
    for (const YamlFields& item : yaml.mappings("tools")) set.tools.push_back(read_tool(item, units, set));
}

std::string tools_to_yaml(const std::filesystem::path& folder, const std::vector<mesh::Tool>& tools) {
    std::string text = tools.empty() ? "" : "tools:\n";
    int number = 0;
    for (const mesh::Tool& tool : tools) {
        text += fmt::format("  - name: {}\n", yaml_text(tool.name));
        text += std::visit(ShapeToYaml{folder, tool, ++number}, tool.shape);
        text += fmt::format("    contact: {}\n", tool.bonded ? "bonded" : "frictionless");
    }
    return text;
}

}  // namespace palpate::identify
