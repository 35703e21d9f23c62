#include "pipeline/output/html/view_tools.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "pipeline/output/html/packed_rows.h"
#include "pipeline/output/json/json_values.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// Of tools' meshes on a page, all together: 0.5 MB in base64, a tenth of what a report may be large.
constexpr Eigen::Index most_tool_triangles = 20'000;

/// The components of a vector, null where one is not known.
json components(const Vec3& vector) {
    json result = json::array();
    for (const double component : vector) result.push_back(known(component));
    return result;
}

/// The triangles whose corners all lie in regions.
std::vector<std::int32_t> patch_in(const std::vector<mesh::Region>& regions, const Points& points,
                                   const Triangles& triangles) {
    const std::vector<char> inside = mesh::contains(regions, points);
    const auto is_inside = [&](int corner) { return inside[static_cast<std::size_t>(corner)] != 0; };
    std::vector<std::int32_t> patch;
    for (const auto& triangle : triangles.rowwise())
        if (std::ranges::all_of(triangle, is_inside)) patch.insert(patch.end(), triangle.begin(), triangle.end());
    return patch;
}

}  // namespace

bool is_of_state(const json& row, const identify::StateName& state) {
    return row["probe"] == state.probe && row["time"] == state.time;
}

json tools_at_rest(const identify::MeasurementSet& set, const Points& points, const Triangles& triangles) {
    json tools = json::array();
    Eigen::Index room = most_tool_triangles;
    for (const mesh::Tool& tool : set.tools) {
        json one{{"name", tool.name},
                 {"origin", numbers(tool.origin)},
                 {"surface", nullptr},
                 {"patch", nullptr},
                 {"triangles_left_out", 0}};
        if (const auto* grip = std::get_if<mesh::GripShape>(&tool.shape)) {
            one["patch"] = packed("i32", patch_in(grip->regions, points, triangles));
        } else if (const auto* shape = std::get_if<mesh::SurfaceShape>(&tool.shape)) {
            const mesh::Surface& surface = shape->surface;
            const Eigen::Index count = surface.triangles.rows();
            if (count <= room) {
                room -= count;
                one["surface"] = {{"points", packed("f32", flat<float>(surface.vertices))},
                                  {"triangles", packed("i32", flat<std::int32_t>(surface.triangles))}};
            } else {
                one["triangles_left_out"] = count;
            }
        }
        tools.push_back(std::move(one));
    }
    return tools;
}

json tools_in_state(const identify::MeasurementSet& set, const identify::StateName& name) {
    json tools = json::array();
    const identify::LoadState* state = identify::find_state(set, name);
    if (!state) return tools;
    for (const mesh::ToolMotion& motion : state->motions) {
        const mesh::Tool& tool = set.tools[static_cast<std::size_t>(motion.tool)];
        json one{{"name", tool.name},
                 {"at", nullptr},
                 {"moved", components(motion.translation)},
                 {"turned", components(motion.rotation)},
                 {"radius", nullptr},
                 {"axis", nullptr},
                 {"measured", nullptr}};
        if (!motion.translation.hasNaN()) one["at"] = numbers(tool.origin + motion.translation);
        if (const auto* ball = std::get_if<mesh::SphereShape>(&tool.shape)) one["radius"] = ball->radius;
        if (const auto* flat = std::get_if<mesh::FlatShape>(&tool.shape); flat && !motion.rotation.hasNaN()) {
            const double angle = motion.rotation.norm();
            const Vec3 axis = angle > 0 ? Eigen::AngleAxisd(angle, motion.rotation / angle) * flat->axis : flat->axis;
            one["radius"] = flat->radius;
            one["axis"] = numbers(axis);
        }
        const auto reading = std::ranges::find(state->reactions, motion.tool, &identify::ReactionReading::tool);
        if (reading != state->reactions.end() && !reading->force.array().isNaN().all())
            one["measured"] = components(reading->force);
        tools.push_back(std::move(one));
    }
    return tools;
}

json modelled_tool_forces(const json& comparison, const identify::StateName& state) {
    json forces = json::array();
    if (comparison.is_null()) return forces;
    for (const json& row : comparison.value("tool_forces", json::array())) {
        if (is_of_state(row, state)) forces.push_back({{"name", row["tool"]}, {"modelled", row["modelled_n"]}});
    }
    return forces;
}

}  // namespace palpate::pipeline
