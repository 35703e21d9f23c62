#include "pipeline/case/case.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/diagnose/diagnose.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/io/region_yaml.h"
#include "mesh/io/yaml_fields.h"
#include "mesh/read_body.h"
#include "pipeline/case/names.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using mesh::YamlFields;

constexpr const char* case_format = "palpate-case/1";
constexpr const char* set_format = "palpate-measurements/1";

double unit_in_mm(const std::string& unit) {
    if (unit == "mm") return 1;
    if (unit == "cm") return 10;
    if (unit == "m") return 1000;
    throw InvalidInput(fmt::format("unit '{}' is not known: use mm, cm or m", unit));
}

template <typename T, typename Read>
void read_if(const YamlFields& yaml, const std::string& key, T& target, Read read) {
    if (yaml.has(key)) target = read(key);
}

void read_material(const YamlFields& yaml, Case& c) {
    read_if(yaml, "young", c.young, [&](auto& key) { return yaml.number(key, 1e-9, 1e9); });
    read_if(yaml, "poisson", c.poisson, [&](auto& key) { return yaml.number(key, -0.99, 0.4999); });
    read_if(yaml, "density", c.density, [&](auto& key) { return yaml.number(key, 0, 1e6); });
    yaml.finish();
}

void read_volume(const YamlFields& yaml, Case& c) {
    read_if(yaml, "edge_length", c.edge_length, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    read_if(yaml, "linear_elements", c.linear_elements, [&](auto& key) { return yaml.boolean(key); });
    yaml.finish();
}

void read_skeleton(const YamlFields& yaml, Case& c) {
    read_if(yaml, "spheres", c.skeleton.spheres, [&](auto& key) { return yaml.integer(key, 0, 100000); });
    read_if(yaml, "coverage", c.skeleton.coverage, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    read_if(yaml, "links", c.skeleton.links,
            [&](auto& key) { return parse(link_kinds, yaml.text(key), yaml.where(key)); });
    read_if(yaml, "zones", c.skeleton.zones, [&](auto& key) { return yaml.integer(key, 1, 1000); });
    read_if(yaml, "sphere_curve", c.sphere_curve, [&](auto& key) { return yaml.boolean(key); });
    yaml.finish();
}

void read_probing(const YamlFields& yaml, ProbeOptions& probing) {
    read_if(yaml, "probes", probing.probes, [&](auto& key) { return yaml.integer(key, 1, 10000); });
    read_if(yaml, "held_out", probing.held_out, [&](auto& key) { return yaml.integer(key, 0, 10000); });
    read_if(yaml, "markers", probing.markers, [&](auto& key) { return yaml.integer(key, 3, 100000); });
    read_if(yaml, "displacement", probing.displacement, [&](auto& key) { return yaml.number(key, 0, 0.5); });
    read_if(yaml, "radius", probing.radius, [&](auto& key) { return yaml.number(key, 1e-9, 0.5); });
    read_if(yaml, "noise", probing.noise, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    yaml.finish();
}

void read_identify(const YamlFields& yaml, identify::IdentifyOptions& options) {
    if (yaml.has("parameters")) options.scope = parse(scopes, yaml.text("parameters"), yaml.where("parameters"));
    if (yaml.has("method")) options.method = parse(methods, yaml.text("method"), yaml.where("method"));
    if (yaml.has("domain")) options.domain = parse(domains, yaml.text("domain"), yaml.where("domain"));
    if (yaml.has("law")) options.law = parse(law_choices, yaml.text("law"), yaml.where("law"));
    if (yaml.has("fixed")) {
        options.fixed.clear();
        for (const std::string& name : yaml.texts("fixed"))
            options.fixed.push_back(parse(stiffnesses, name, yaml.where("fixed")));
    }
    read_if(yaml, "particles", options.particles, [&](auto& key) { return yaml.integer(key, 0, 10'000'000); });
    read_if(yaml, "iterations", options.iterations, [&](auto& key) { return yaml.integer(key, 1, 100000); });
    read_if(yaml, "search_low", options.search_low, [&](auto& key) { return yaml.number(key, 1e-9, 1e9); });
    read_if(yaml, "search_high", options.search_high, [&](auto& key) { return yaml.number(key, 1e-9, 1e9); });
    yaml.finish();
}

void read_inquiry(const YamlFields& yaml, InquiryOptions& options) {
    read_if(yaml, "reference", options.reference, [&](auto& key) { return yaml.boolean(key); });
    if (yaml.has("without")) options.without = yaml.texts("without");
    yaml.finish();
}

void read_expectation(const YamlFields& yaml, Expectation& expect) {
    read_if(yaml, "relative_at_most", expect.relative_at_most, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    read_if(yaml, "held_out_at_most", expect.held_out_at_most, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    if (yaml.has("parameters")) {
        for (const YamlFields& item : yaml.mappings("parameters")) {
            expect.parameters.push_back(
                {item.text("name"), item.number("value", 1e-30, 1e30), item.number("within", 0, 1e9)});
            item.finish();
        }
    }
    read_if(yaml, "modes", expect.modes, [&](auto& key) { return yaml.integer(key, 1, 100); });
    read_if(yaml, "spheres_at_least", expect.spheres_at_least,
            [&](auto& key) { return yaml.integer(key, 1, 1000000); });
    if (yaml.has("verdict")) {
        expect.verdict = yaml.choice("verdict", {identify::verdict_names.begin(), identify::verdict_names.end()});
    }
    if (yaml.has("explanation")) expect.explanation = yaml.texts("explanation");
    read_if(yaml, "rms_at_most_mm", expect.rms_at_most_mm, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    yaml.finish();
}

Case read_case_file(const YamlFields& yaml) {
    Case c;
    c.file = yaml.file();
    yaml.choice("format", {case_format});
    c.name = yaml.has("name") ? yaml.text("name") : c.file.stem().string();
    const fs::path folder = c.file.parent_path();
    if (yaml.has("mesh")) c.mesh = folder / yaml.text("mesh");
    if (yaml.has("measurements")) c.measurements = folder / yaml.text("measurements");
    if (yaml.has("model")) c.model = folder / yaml.text("model");
    if (c.model && !c.measurements) {
        throw InvalidInput(
            fmt::format("{}: a model needs measurements to be fitted to; name a set beside it", yaml.where("model")));
    }
    if (c.mesh.has_value() == c.measurements.has_value()) {
        throw InvalidInput(
            fmt::format("{}: name either 'mesh' (a surface; simulation makes the measurements) or "
                        "'measurements' (a set), {}",
                        c.file.string(), c.mesh ? "not both" : "neither is there"));
    }
    if (yaml.has("unit")) c.unit = unit_in_mm(yaml.choice("unit", {"mm", "cm", "m"}));
    read_if(yaml, "longest", c.longest, [&](auto& key) { return yaml.number(key, 0, 1e9); });
    read_if(yaml, "label", c.label, [&](auto& key) { return yaml.integer(key, -1'000'000'000, 1'000'000'000); });
    if (yaml.has("supports")) c.supports = mesh::read_regions(yaml, "supports", 1.0);
    if (yaml.has("material")) read_material(yaml.mapping("material"), c);
    if (yaml.has("volume")) read_volume(yaml.mapping("volume"), c);
    if (yaml.has("skeleton")) read_skeleton(yaml.mapping("skeleton"), c);
    if (yaml.has("probing")) read_probing(yaml.mapping("probing"), c.probing);
    if (yaml.has("identify")) read_identify(yaml.mapping("identify"), c.identify);
    if (yaml.has("diagnose")) read_inquiry(yaml.mapping("diagnose"), c.diagnose);
    if (yaml.has("expect")) read_expectation(yaml.mapping("expect"), c.expect);
    if (yaml.has("seed")) c.identify.seed = static_cast<std::uint64_t>(yaml.integer("seed", 0, 2'000'000'000));
    yaml.finish();
    return c;
}

Case case_of_input(const fs::path& input) {
    if (!fs::exists(input)) throw IoError(fmt::format("{}: there is no such file or folder", input.string()));
    Case c;
    if (fs::is_directory(input)) {
        const fs::path set = input / "set.yaml", own = input / "case.yaml";
        if (fs::exists(set)) {
            c.measurements = input;
        } else if (fs::exists(own)) {
            return read_case_file(YamlFields::from_file(own));
        } else {
            throw InvalidInput(
                fmt::format("{}: the folder holds neither set.yaml (a measurement set) nor case.yaml", input.string()));
        }
    } else if (mesh::is_body_file(input)) {
        c.mesh = input;
    } else if (input.extension() == ".yaml" || input.extension() == ".yml") {
        const YamlFields yaml = YamlFields::from_file(input);
        const std::string format = yaml.choice("format", {case_format, set_format});
        if (format == case_format) return read_case_file(yaml);
        c.measurements = input.has_parent_path() ? input.parent_path() : fs::path(".");
    } else {
        throw InvalidInput(
            fmt::format("{}: not a kind of input that is known: give a case.yaml, a measurement set (its "
                        "folder or set.yaml) or a body: {}",
                        input.string(), mesh::body_extensions));
    }
    const fs::path named = c.measurements ? fs::weakly_canonical(*c.measurements) : input;
    c.name = mesh::body_name(named);
    return c;
}

void override_case(Case& c, const CaseOverrides& say) {
    if (!say.unit.empty()) c.unit = unit_in_mm(say.unit);
    if (say.longest) c.longest = *say.longest;
    if (say.label) c.label = say.label;
    if (say.young) c.young = say.young;
    if (say.poisson) c.poisson = say.poisson;
    if (say.density) c.density = say.density;
    if (say.edge_length) c.edge_length = *say.edge_length;
    if (say.linear_elements) c.linear_elements = true;
    if (say.no_reference) c.diagnose.reference = false;
    if (say.sphere_curve) c.sphere_curve = true;
    if (say.spheres) c.skeleton.spheres = *say.spheres;
    if (say.coverage) c.skeleton.coverage = *say.coverage;
    if (!say.links.empty()) c.skeleton.links = parse(link_kinds, say.links, "--links");
    if (say.zones) c.skeleton.zones = *say.zones;
    if (say.probes) {
        c.probing.probes = *say.probes;
        c.probing.held_out = std::min(c.probing.held_out, *say.probes / 5);
    }
    if (say.markers) c.probing.markers = *say.markers;
    if (say.displacement) c.probing.displacement = *say.displacement;
    if (say.noise) c.probing.noise = *say.noise;
    if (say.particles) c.identify.particles = *say.particles;
    if (!say.parameters.empty()) c.identify.scope = parse(scopes, say.parameters, "--parameters");
    if (!say.method.empty()) c.identify.method = parse(methods, say.method, "--method");
    if (!say.domain.empty()) c.identify.domain = parse(domains, say.domain, "--domain");
    if (say.seed) c.identify.seed = *say.seed;
}

void require(bool holds, const std::string& what, double value, const std::string& allowed) {
    if (!holds) throw InvalidInput(fmt::format("{} is {}, allowed is {}", what, value, allowed));
}

}  // namespace

void ProbeOptions::validate() const {
    require(probes >= 1 && probes <= 10000, "probes", probes, "1 to 10000");
    require(held_out >= 0 && held_out < probes, "held_out", held_out, "0 to one less than the probes");
    require(markers >= 3 && markers <= 100000, "markers", markers, "3 to 100000");
    require(displacement >= 0 && displacement <= 0.5, "displacement", displacement, "0 to 0.5 of the longest side");
    require(radius > 0 && radius <= 0.5, "radius", radius, "above 0 to 0.5 of the longest side");
    require(noise >= 0, "noise", noise, "0 mm or more");
}

void InquiryOptions::validate() const {
    for (const std::string& name : without) identify::find_effect(name);
}

Case read_case(const std::filesystem::path& input, const CaseOverrides& overrides) {
    Case c = case_of_input(input);
    override_case(c, overrides);
    c.probing.validate();
    c.skeleton.validate();
    c.identify.validate();
    c.diagnose.validate();
    require(c.longest >= 0, "longest", c.longest, "a length in mm above 0");
    require(c.edge_length >= 0, "edge_length", c.edge_length, "a length in mm above 0");
    fem::Material material;
    if (c.young) material.young = *c.young;
    if (c.poisson) material.poisson = *c.poisson;
    if (c.density) material.density = *c.density * fem::tonne_per_mm3;
    material.validate();
    return c;
}

}  // namespace palpate::pipeline
