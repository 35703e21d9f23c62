#include "pipeline/play/pick/pick_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "mesh/supports/region_yaml.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/packed_rows.h"
#include "pipeline/output/html/page_frame.h"
#include "pipeline/output/text/words.h"
#include "pipeline/play/pick/page_parts.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

struct RegionJson {
    json operator()(const mesh::BoxRegion& box) const {
        return {{"box", {{"min", vector_json(box.min)}, {"max", vector_json(box.max)}}}};
    }
    json operator()(const mesh::SphereRegion& ball) const {
        return {{"sphere", {{"center", vector_json(ball.center)}, {"radius", ball.radius}}}};
    }
    json operator()(const mesh::PlaneRegion& plane) const {
        return {
            {"plane",
             {{"point", vector_json(plane.point)}, {"normal", vector_json(plane.normal)}, {"within", plane.within}}}};
    }
    /// The page cannot draw it: it keeps the line of YAML.
    json operator()(const mesh::PointsRegion& points) const {
        std::string line = mesh::regions_to_yaml({points});
        while (!line.empty() && line.back() == '\n') line.pop_back();
        return {{"line", line}};
    }
};

/// What a case says of the body's file.
std::string body_yaml(const Case& settings) {
    std::string text = fmt::format("mesh: {}   # beside this file\n", json(settings.mesh->filename().string()).dump());
    const Case defaults;
    for (const char* key : {"unit", "longest", "label", "keep"}) {
        const json value = setting_at(key).value(settings);
        if (value != setting_at(key).value(defaults)) text += fmt::format("{}: {}\n", key, value.dump());
    }
    return text;
}

json pick_json(const Subject& subject) {
    const Points& vertices = subject.surface.vertices;
    const bool is_default_clamp = !subject.set && subject.settings.supports.empty();
    json data{{"name", subject.set && !subject.set->name.empty() ? subject.set->name : subject.settings.name},
              {"kind", subject.set                     ? "set"
                       : subject.settings.file.empty() ? "mesh"
                                                       : "case"},
              {"body", subject.settings.mesh ? body_yaml(subject.settings) : ""},
              {"young", subject.material.young},
              {"surface",
               {{"points", packed("f32", flat<float>(vertices))},
                {"triangles", packed("i32", flat<std::int32_t>(subject.surface.triangles))},
                {"held", json::array()}}},
              {"supports", json::array()},
              {"states", json::array()},
              {"markers", json::array()},
              {"notes", subject.notes}};
    if (!is_default_clamp) {
        for (const mesh::Region& region : subject.supports)
            data["supports"].push_back(std::visit(RegionJson(), region));
        const std::vector<char> held = mesh::contains(subject.supports, vertices);
        for (std::size_t v = 0; v < held.size(); ++v)
            if (held[v] != 0) data["surface"]["held"].push_back(v);
    }
    if (!subject.set) return data;
    for (const identify::LoadState& state : subject.set->states) {
        if (state.contacts.empty())
            data["states"].push_back({{"probe", state.probe}, {"at", {0, 0, 0}}, {"force", {0, 0, 0}}});
        for (const mesh::Contact& contact : state.contacts)
            data["states"].push_back(
                {{"probe", state.probe}, {"at", vector_json(contact.point)}, {"force", vector_json(contact.force)}});
    }
    for (const identify::Marker& marker : subject.set->markers)
        data["markers"].push_back({{"name", label_of(marker)}, {"at", vector_json(marker.rest)}});
    return data;
}

}  // namespace

std::string pick_page(const Subject& subject) {
    const json data = pick_json(subject);
    return page_head("Set up " + data["name"].get<std::string>(), pick_style) + "<body>\n" + std::string(pick_view) +
           "<script id=\"pick-data\" type=\"application/json\">" + as_script_data(data) + "</script><script>" +
           std::string(pick_script) + "</script></body></html>\n";
}

}  // namespace palpate::pipeline
