#include <fmt/format.h>

#include "mesh/io/region_yaml.h"
#include "pipeline/case/case.h"
#include "pipeline/case/names.h"

namespace palpate::pipeline {
namespace {

std::string optional_line(const char* format, const std::optional<double>& value) {
    return value ? fmt::format(fmt::runtime(format), *value) : "";
}

/// A text in single quotes, whatever it holds.
std::string quoted(const std::string& text) {
    std::string escaped;
    for (const char c : text) escaped += c == '\'' ? "''" : std::string(1, c);
    return "'" + escaped + "'";
}

std::string joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

std::string fixed_names(const identify::IdentifyOptions& options) {
    std::string names;
    for (const auto kind : options.fixed) names += (names.empty() ? "" : ", ") + name_of(stiffnesses, kind);
    return names;
}

std::string expectation_yaml(const Expectation& e) {
    std::string text = optional_line("  relative_at_most: {}\n", e.relative_at_most) +
                       optional_line("  held_out_at_most: {}\n", e.held_out_at_most);
    if (!e.parameters.empty()) text += "  parameters:\n";
    for (const auto& p : e.parameters) {
        text += fmt::format("    - {{name: {}, value: {}, within: {}}}\n", quoted(p.name), p.value, p.within);
    }
    if (e.modes) text += fmt::format("  modes: {}\n", *e.modes);
    if (e.spheres_at_least) text += fmt::format("  spheres_at_least: {}\n", *e.spheres_at_least);
    if (e.verdict) text += "  verdict: " + *e.verdict + "\n";
    if (e.explanation) text += "  explanation: [" + joined(*e.explanation) + "]\n";
    text += optional_line("  rms_at_most_mm: {}\n", e.rms_at_most_mm);
    return text.empty() ? text : "expect:\n" + text;
}

std::string input_yaml(const Case& c) {
    std::string text = fmt::format("name: {}\n", quoted(c.name));
    if (c.mesh) {
        text += fmt::format("mesh: {}\n", quoted(std::filesystem::absolute(*c.mesh).lexically_normal().string()));
        text += fmt::format("unit: {}            # of the mesh\n", c.unit == 1 ? "mm" : c.unit == 10 ? "cm" : "m");
        text += fmt::format("longest: {}          # scale the mesh to this longest side [mm]; 0: not\n", c.longest);
        if (c.label) text += fmt::format("label: {}            # of the label image\n", *c.label);
    } else {
        text += fmt::format("measurements: {}\n",
                            quoted(std::filesystem::absolute(*c.measurements).lexically_normal().string()));
        if (c.model)
            text += fmt::format("model: {}\n", quoted(std::filesystem::absolute(*c.model).lexically_normal().string()));
    }
    if (!c.supports.empty())
        text += "supports:             # where the body is held [mm]\n" + mesh::regions_to_yaml(c.supports);
    if (c.young || c.poisson || c.density) {
        text += "material:\n" + optional_line("  young: {}            # [MPa]\n", c.young) +
                optional_line("  poisson: {}\n", c.poisson) +
                optional_line("  density: {}          # [kg/m^3]\n", c.density);
    }
    return text;
}

}  // namespace

std::string to_yaml(const Case& c) {
    std::string text = "# Settings of a palpate run, defaults included.\nformat: palpate-case/1\n" + input_yaml(c);
    text += fmt::format(
        "volume:\n"
        "  edge_length: {}      # of the tetrahedra [mm]; 0: 6 % of the longest side, less in a thin body\n"
        "  linear_elements: {}\n"
        "skeleton:\n"
        "  spheres: {}          # that are free to move; 0: by the body's shape\n"
        "  coverage: {}         # [mm] no surface further outside the spheres; 0: 5 % of the longest side\n"
        "  links: {}            # full; burion2008: the paper's elongation, flexion, torsion\n"
        "  zones: {}\n"
        "  sphere_curve: {}     # measure what fewer and more spheres would do: takes several times as long\n",
        c.edge_length, c.linear_elements, c.skeleton.spheres, c.skeleton.coverage,
        name_of(link_kinds, c.skeleton.links), c.skeleton.zones, c.sphere_curve);
    if (c.mesh) {
        const ProbeOptions& p = c.probing;
        text += fmt::format(
            "probing:              # by the reference simulation\n"
            "  probes: {}\n"
            "  held_out: {}         # of them, kept from the fit\n"
            "  markers: {}\n"
            "  displacement: {}     # largest, as a share of the longest side; 0: 0.5 % in small strain, 5 % in large\n"
            "  radius: {}           # of a contact, as a share of the longest side\n"
            "  noise: {}            # 1 sigma [mm]\n",
            p.probes, p.held_out, p.markers, p.displacement, p.radius, p.noise);
    }
    const identify::IdentifyOptions& i = c.identify;
    text += fmt::format(
        "identify:\n"
        "  parameters: {}       # uniform, zones, links\n"
        "  method: {}           # tempered, burion2008\n"
        "  domain: {}           # by-method, position, force\n"
        "  law: {}              # automatic, linear, large-rotation\n"
        "  fixed: [{}]           # elongation, flexion, torsion: taken as the model has them\n"
        "  particles: {}        # 0: 200 (tempered), 600 (burion2008)\n"
        "  iterations: {}       # burion2008\n"
        "  search_low: {}       # burion2008: search box, as multiples of the start stiffness\n"
        "  search_high: {}\n"
        "seed: {}\n",
        name_of(scopes, i.scope), name_of(methods, i.method), name_of(domains, i.domain), name_of(law_choices, i.law),
        fixed_names(i), i.particles, i.iterations, i.search_low, i.search_high, i.seed);
    text += fmt::format(
        "diagnose:\n"
        "  reference: {}        # ask the body in finite elements what is missing\n"
        "  without: [{}]          # effects left out of the catalogue\n",
        c.diagnose.reference, joined(c.diagnose.without));
    return text + expectation_yaml(c.expect);
}

}  // namespace palpate::pipeline
