#include <fmt/format.h>

#include "fem/material.h"
#include "mesh/supports/region_yaml.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/settings/settings.h"

namespace palpate::pipeline {
namespace {

/// A text in single quotes, whatever it holds.
std::string quoted(const std::string& text) {
    std::string escaped;
    for (const char c : text) escaped += c == '\'' ? "''" : std::string(1, c);
    return "'" + escaped + "'";
}

std::string path_yaml(const char* key, const std::filesystem::path& path) {
    return fmt::format("{}: {}\n", key, quoted(std::filesystem::absolute(path).lexically_normal().string()));
}

std::string expectation_yaml(const Case& c) {
    std::string text = section_yaml(c, "expect");
    if (c.expect.parameters.empty()) return text;
    text += text.empty() ? "expect:\n  parameters:\n" : "  parameters:\n";
    for (const auto& p : c.expect.parameters)
        text += fmt::format("    - {{name: {}, value: {}, within: {}}}\n", quoted(p.name), p.value, p.within);
    return text;
}

std::string regions_yaml(const std::vector<mesh::MaterialRegion>& regions) {
    std::string text =
        regions.empty() ? "" : "regions:                      # of materials of their own [MPa, kg/m^3]\n";
    for (const mesh::MaterialRegion& region : regions) {
        text +=
            fmt::format("  - name: {}\n    {}", quoted(region.name),
                        region.label ? fmt::format("label: {}\n", *region.label) : path_yaml("surface", region.file));
        if (region.young) text += fmt::format("    young: {}\n", *region.young);
        if (region.poisson) text += fmt::format("    poisson: {}\n", *region.poisson);
        if (region.density) text += fmt::format("    density: {:.12g}\n", *region.density / fem::tonne_per_mm3);
    }
    return text;
}

std::string input_yaml(const Case& c) {
    std::string text = fmt::format("name: {}\n", quoted(c.name));
    if (c.mesh) {
        text += path_yaml("mesh", *c.mesh);
        for (const char* place : {"unit", "longest", "label", "keep"}) text += setting_yaml(c, setting_at(place));
    } else {
        text += path_yaml("measurements", *c.measurements);
        if (c.model) text += path_yaml("model", *c.model);
    }
    text += regions_yaml(c.regions);
    if (!c.supports.empty())
        text += "supports:                     # where the body is held [mm]\n" + mesh::regions_to_yaml(c.supports);
    return text;
}

}  // namespace

std::string to_yaml(const Case& c) {
    std::string text = "# Settings of a palpate run, defaults included.\nformat: palpate-case/1\n" + input_yaml(c);
    for (const char* section : {"material", "volume", "skeleton"}) text += section_yaml(c, section);
    if (c.mesh) text += section_yaml(c, "probing");
    text += section_yaml(c, "identify") + section_yaml(c, "diagnose") + setting_yaml(c, setting_at("seed"));
    return text + expectation_yaml(c);
}

}  // namespace palpate::pipeline
