#include "pipeline/case/settings/read_case.h"

#include <fmt/format.h>

#include <algorithm>

#include "fem/material.h"
#include "identify/measurements/files/rig/regions_yaml.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "mesh/supports/region_yaml.h"
#include "pipeline/case/settings/overrides.h"
#include "pipeline/case/settings/settings.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using mesh::YamlFields;

constexpr const char* case_format = "palpate-case/1";
constexpr const char *set_format = "palpate-measurements/1", *second_set_format = "palpate-measurements/2";

void read_expected_parameters(const YamlFields& yaml, Expectation& expect) {
    if (!yaml.has("parameters")) return;
    for (const YamlFields& item : yaml.mappings("parameters")) {
        expect.parameters.push_back(
            {item.text("name"), item.number("value", 1e-30, 1e30), item.number("within", 0, 1e9)});
        item.finish();
    }
}

/// What the section says. @throws InvalidInput.
void read_section(const YamlFields& yaml, const std::string& section, Case& c) {
    for (const CaseSetting& setting : settings())
        if (setting.section == section && yaml.has(setting.key)) setting.read(yaml, c);
    if (section == "expect") read_expected_parameters(yaml, c.expect);
    if (!section.empty()) yaml.finish();
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
    c.regions = identify::read_material_regions(yaml, 1.0, folder, identify::RegionFiles::anywhere);
    if (!c.regions.empty() && !c.mesh)
        throw InvalidInput(
            fmt::format("{}: regions of a measurement set stand in its set.yaml; a case has regions with a 'mesh' only",
                        yaml.where("regions")));
    if (yaml.has("supports")) c.supports = mesh::read_regions(yaml, "supports", 1.0);
    read_section(yaml, "", c);
    for (const char* section : {"material", "volume", "skeleton", "probing", "identify", "diagnose", "expect"})
        if (yaml.has(section)) read_section(yaml.mapping(section), section, c);
    yaml.finish();
    return c;
}

Case case_of_input(const fs::path& input) {
    if (!fs::exists(input)) throw IoError(fmt::format("{}: no such file or folder.", input.string()));
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
        const std::string format = yaml.choice("format", {case_format, set_format, second_set_format});
        if (format == case_format) return read_case_file(yaml);
        c.measurements = input.has_parent_path() ? input.parent_path() : fs::path(".");
    } else {
        throw InvalidInput(
            fmt::format("{}: not a kind of input that is known: give a case.yaml, a measurement set (its "
                        "folder or set.yaml) or a body: {}",
                        input.string(), mesh::body_extensions()));
    }
    const fs::path named = c.measurements ? fs::weakly_canonical(*c.measurements) : input;
    c.name = mesh::body_name(named);
    return c;
}

}  // namespace

Case read_case(const std::filesystem::path& input) { return read_case(input, {}); }

Case read_case(const std::filesystem::path& input, const CaseOverrides& overrides) {
    Case c = case_of_input(input);
    overrides.apply(c);
    if (overrides.has("probing.probes")) c.probing.held_out = std::min(c.probing.held_out, c.probing.probes / 5);
    c.probing.validate();
    c.skeleton.validate();
    c.identify.validate();
    c.diagnose.validate();
    fem::Material material;
    if (c.young) material.young = *c.young;
    if (c.poisson) material.poisson = *c.poisson;
    if (c.density) material.density = *c.density * fem::tonne_per_mm3;
    material.validate();
    return c;
}

}  // namespace palpate::pipeline
