#include "pipeline/cli/check/held.h"

#include <fmt/format.h>

#include <variant>

#include "mesh/supports/held_parts.h"

namespace palpate::pipeline::commands {
namespace {

/// What each of these regions holds of the mesh, or of the surface.
std::vector<mesh::HeldPart> parts_within(const std::vector<mesh::Region>& regions, const Subject& subject) {
    constexpr double spacing = 0.005;  // of samples of the surface, as a share of the longest side: areas to 1 %
    if (subject.volume) return mesh::held_parts(regions, *subject.volume);
    return mesh::held_parts(regions, subject.surface,
                            spacing * mesh::bounding_box(subject.surface.vertices).longest_side());
}

}  // namespace

void add_supports(const Subject& subject, Outcome& outcome) {
    const std::vector<mesh::HeldPart> parts = parts_within(subject.supports, subject);
    std::vector<std::string> warnings;
    if (subject.volume) warnings = mesh::too_little_held(subject.supports, *subject.volume);
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string words = mesh::describe_held_part(
            subject.supports, parts, i, subject.volume ? "nodes of the mesh" : "vertices of the surface");
        outcome.text += "Held by " + words + ".\n";
        list.push_back({{"nodes", parts[i].nodes}, {"area_mm2", parts[i].area}, {"words", words}});
        if (!subject.volume && parts[i].area == 0)
            warnings.push_back(
                fmt::format("Support {} holds nothing of the surface: it is for material inside the "
                            "body alone, or its unit or frame is not the body's.",
                            i + 1));
    }
    for (const std::string& warning : warnings) outcome.text += "  - warning: " + warning + "\n";
    outcome.json["supports"] = list;
    outcome.json["warnings"] = warnings;
}

void add_grips(const Subject& subject, Outcome& outcome) {
    for (std::size_t t = 0; t < subject.set->tools.size(); ++t) {
        const mesh::Tool& tool = subject.set->tools[t];
        const auto* grip = std::get_if<mesh::GripShape>(&tool.shape);
        if (!grip) continue;
        mesh::HeldPart whole;
        for (const mesh::HeldPart& part : parts_within(grip->regions, subject)) {
            whole.nodes += part.nodes;
            whole.area += part.area;
        }
        outcome.text +=
            fmt::format("Tool '{}' grips {} {} and {}.\n", tool.name, whole.nodes,
                        subject.volume ? "nodes of the mesh" : "vertices", mesh::surface_in_words(whole.area));
        outcome.json["set"]["tools"][t]["grips"] = {{"nodes", whole.nodes}, {"area_mm2", whole.area}};
        if (whole.nodes > 0 || whole.area > 0) continue;
        const std::string warning = fmt::format(
            "Tool '{}' grips nothing of the surface: it is for material inside the body alone, or its unit or frame is "
            "not the body's.",
            tool.name);
        outcome.text += "  - warning: " + warning + "\n";
        outcome.json["warnings"].push_back(warning);
    }
}

}  // namespace palpate::pipeline::commands
