#include "pipeline/output/html/check/check_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/numerics/summaries.h"
#include "mesh/text/words.h"
#include "pipeline/output/html/packed_rows.h"
#include "pipeline/output/html/view_tools.h"
#include "pipeline/output/json/json_values.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// Vertices that lie in regions.
std::vector<int> inside(const std::vector<mesh::Region>& regions, const Points& vertices) {
    std::vector<int> list;
    if (regions.empty()) return list;
    const auto flags = mesh::contains(regions, vertices);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v)
        if (flags[static_cast<std::size_t>(v)] != 0) list.push_back(static_cast<int>(v));
    return list;
}

/// The part whose middle lies nearest to each vertex.
json parts_of(const Points& vertices, const json& preflight) {
    json list = json::array();
    if (preflight.is_null() || preflight["parts"].empty()) return list;
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        int nearest = 0;
        double least = INFINITY;
        for (std::size_t p = 0; p < preflight["parts"].size(); ++p) {
            const json& at = preflight["parts"][p]["at"];
            const double distance = (vertices.row(v) - Eigen::RowVector3d(at[0], at[1], at[2])).squaredNorm();
            if (distance >= least) continue;
            least = distance;
            nearest = static_cast<int>(p);
        }
        list.push_back(nearest);
    }
    return list;
}

json tendons_json(const identify::MeasurementSet& set) {
    json list = json::array();
    for (const mesh::Actuator& actuator : set.actuators) {
        const auto* tendon = std::get_if<mesh::TendonActuator>(&actuator.kind);
        if (!tendon) continue;
        json path = json::array();
        for (Eigen::Index p = 0; p < tendon->path.rows(); ++p) path.push_back(numbers(tendon->path.row(p)));
        list.push_back(path);
    }
    return list;
}

std::string words_of(const identify::MeasurementSet& set, const identify::LoadState& state) {
    std::string words;
    const auto add = [&](const std::string& more) { words += (words.empty() ? "" : ", ") + more; };
    for (const mesh::Contact& contact : state.contacts)
        if (!contact.force.isZero(0)) add(fmt::format("{:.3g} N", contact.force.norm()));
    for (const mesh::ToolMotion& motion : state.motions)
        add(fmt::format("{} moved by {:.3g} mm", set.tools[static_cast<std::size_t>(motion.tool)].name,
                        identify::known_part(motion.translation).norm()));
    for (const identify::Actuation& one : state.actuations)
        add(fmt::format("{} at {:.3g}", set.actuators[static_cast<std::size_t>(one.actuator)].name, one.value));
    if (words.empty()) words = "no load is stated";
    words += fmt::format("; {} read", mesh::count_of(std::ssize(state.readings), "marker"));
    if (!state.reactions.empty()) words += ", " + mesh::count_of(std::ssize(state.reactions), "reaction");
    return words + ".";
}

/// Markers by name, of suspicions in a state or of all.
json odd_markers(const std::map<std::string, int>& by_name, const json& preflight, const identify::LoadState* state) {
    json list = json::array();
    if (preflight.is_null()) return list;
    for (const json& one : preflight["suspicions"]) {
        const json& where = one["state"];
        const bool is_here = state ? !where.is_null() && where["probe"] == state->probe && where["time"] == state->time
                                   : where.is_null();
        if (!is_here) continue;
        for (const char* key : {"marker", "other"})
            if (one.contains(key)) list.push_back(by_name.at(one[key].get<std::string>()));
    }
    return list;
}

json picture_of_state(const identify::MeasurementSet& set, const identify::LoadState& state,
                      const std::map<std::string, int>& by_name, const json& preflight) {
    Points moved = Points::Constant(std::ssize(set.markers), 3, identify::missing);
    for (const identify::Reading& reading : state.readings) {
        if (!is_usable(reading)) continue;
        const Vec3 rest = set.markers[static_cast<std::size_t>(reading.marker)].rest;
        moved.row(reading.marker) = identify::known_part(reading.position - rest);
    }
    json loads = json::array();
    for (const mesh::Contact& contact : state.contacts) {
        if (contact.force.isZero(0)) continue;
        loads.push_back({contact.point.x(), contact.point.y(), contact.point.z(), contact.force.x(), contact.force.y(),
                         contact.force.z()});
    }
    return {{"name", fmt::format("Probe {} at {:g} s", state.probe, state.time)},
            {"words", words_of(set, state)},
            {"loads", loads},
            {"tools", tools_in_state(set, {state.probe, state.time})},
            {"moved", packed("f32", flat<float>(moved))},
            {"odd", odd_markers(by_name, preflight, &state)}};
}

}  // namespace

json check_picture(const Subject& subject, const json& preflight) {
    const Points& vertices = subject.surface.vertices;
    json data{{"surface",
               {{"points", packed("f32", flat<float>(vertices))},
                {"triangles", packed("i32", flat<std::int32_t>(subject.surface.triangles))},
                {"held", inside(subject.supports, vertices)},
                {"gripped", json::array()},
                {"part", parts_of(vertices, preflight)}}},
              {"parts", json::array()},
              {"markers",
               {{"rest", packed("f32", flat<float>(Points(0, 3)))}, {"names", json::array()}, {"odd", json::array()}}},
              {"tools", json::array()},
              {"tendons", json::array()},
              {"states", json::array()}};
    if (!preflight.is_null())
        for (const json& part : preflight["parts"]) data["parts"].push_back({{"sd", part["sd_of_log_stiffness"]}});
    if (!subject.set) return data;

    const identify::MeasurementSet& set = *subject.set;
    Points rest(std::ssize(set.markers), 3);
    std::map<std::string, int> by_name;
    for (std::size_t m = 0; m < set.markers.size(); ++m) {
        rest.row(static_cast<Eigen::Index>(m)) = set.markers[m].rest;
        by_name[label_of(set.markers[m])] = static_cast<int>(m);
        data["markers"]["names"].push_back(label_of(set.markers[m]));
    }
    data["markers"]["rest"] = packed("f32", flat<float>(rest));
    data["markers"]["odd"] = odd_markers(by_name, preflight, nullptr);
    data["tools"] = tools_at_rest(set, vertices, subject.surface.triangles);
    data["tendons"] = tendons_json(set);
    for (const mesh::Tool& tool : set.tools) {
        const auto* grip = std::get_if<mesh::GripShape>(&tool.shape);
        if (!grip) continue;
        for (const int v : inside(grip->regions, vertices)) data["surface"]["gripped"].push_back(v);
    }
    constexpr std::size_t most_states = 400;  // 1 MB of a hundred markers
    const std::size_t step = 1 + set.states.size() / most_states;
    for (std::size_t s = 0; s < set.states.size(); s += step)
        data["states"].push_back(picture_of_state(set, set.states[s], by_name, preflight));
    return data;
}

}  // namespace palpate::pipeline
