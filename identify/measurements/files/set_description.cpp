#include "identify/measurements/files/set_description.h"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>

#include "identify/measurements/files/path_inside.h"
#include "identify/measurements/files/rig/regions_yaml.h"
#include "identify/measurements/files/rig/rig_yaml.h"
#include "identify/measurements/files/second_format.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "mesh/regions/labels.h"
#include "mesh/supports/region_yaml.h"

namespace palpate::identify {

using mesh::YamlFields;

namespace {

MaterialGuess read_material(const YamlFields& fields) {
    MaterialGuess material;
    if (fields.has("young")) material.young = fields.number("young", 1e-9, 1e9);  // MPa; diamond has 1.2e6
    if (fields.has("poisson")) material.poisson = fields.number("poisson");
    if (material.poisson <= -1 || material.poisson >= 0.5)
        throw InvalidInput(fmt::format("{}: {} must lie between -1 and 0.5, both excluded (0.499 for rubber).",
                                       fields.where("poisson"), material.poisson));
    fields.finish();
    return material;
}

bool read_format(const YamlFields& fields) {
    const std::string format = fields.text("format");
    if (format != first_format_name && format != second_format_name)
        throw InvalidInput(fmt::format("{}: '{}' is not a format that is read here. Only '{}' and '{}' are.",
                                       fields.where("format"), format, first_format_name, second_format_name));
    return format == first_format_name;
}

void read_noise(const YamlFields& noise, const SetUnits& units, MeasurementSet& set) {
    const auto read = [&](const char* key, double unit, double least, double most, std::optional<double>& sigma) {
        if (noise.has(key)) sigma = unit * noise.number(key, least / unit, most);
    };
    read("position", units.length, least_position_noise, 1e6, set.position_noise);
    read("force", units.force, least_force_noise, 1e9, set.force_noise);
    read("reaction", units.force, least_force_noise, 1e9, set.reaction_noise);
    read("moment", units.moment, least_moment_noise, 1e12, set.moment_noise);
    noise.finish();
}

std::optional<StateName> read_reference(const YamlFields& fields) {
    if (!fields.has("displacements")) return std::nullopt;
    const YamlFields displacements = fields.mapping("displacements");
    const YamlFields since = displacements.mapping("since");
    constexpr int most = std::numeric_limits<int>::max();
    const StateName name{since.integer("probe", -most, most), since.number("time")};
    since.finish();
    displacements.finish();
    return name;
}

void read_correlation(const YamlFields& fields, double unit, MeasurementSet& set) {
    if (!fields.has("correlated")) return;
    const YamlFields correlated = fields.mapping("correlated");
    set.position_correlation = unit * correlated.number("position", 1e-9, 1e9);
    correlated.finish();
}

void read_rest(const std::filesystem::path& file, double unit, MeasurementSet& set) {
    mesh::BodyFile rest = mesh::read_body(file, {.label = {}, .parts = mesh::labels_of(set.regions)});
    const double scale = rest.is_in_mm ? 1 : unit;
    set.rest_surface = std::move(rest.surface);
    set.rest_surface.vertices *= scale;
    set.rest_volume = std::move(rest.volume);
    if (set.rest_volume) set.rest_volume->nodes *= scale;
    mesh::take_parts(rest.parts, scale, set.regions);
}

}  // namespace

void read_conditions(const YamlFields& fields, const SetUnits& units, MeasurementSet& set) {
    check_region_paths(fields.mappings("supports"), set.folder);
    set.supports = mesh::read_regions(fields, "supports", units.length);

    // A density in another unit than kg/m^3 is far outside: air has 1, the heaviest metal 22,600.
    if (fields.has("density")) set.density = fields.number("density", 1, 30000) / 1e12;  // kg/m^3 in tonne/mm^3
    if (fields.has("history")) set.continuous = fields.choice("history", {"fresh", "continuous"}) == "continuous";
    if (fields.has("gravity")) set.gravity = units.length * fields.vector("gravity");
    if (fields.has("noise")) read_noise(fields.mapping("noise"), units, set);
    read_correlation(fields, units.length, set);
    if (fields.has("material")) set.material = read_material(fields.mapping("material"));
}

SetDescription read_set_description(const std::filesystem::path& file, MeasurementSet& set) {
    const YamlFields fields = YamlFields::from_file(file);
    SetDescription description;
    description.is_first_format = read_format(fields);
    set.folder = file.parent_path();
    check_parts(fields, description.is_first_format, set.folder);
    set.name = fields.has("name") ? fields.text("name") : std::filesystem::absolute(set.folder).filename().string();
    description.units = read_units(fields);
    const SetUnits& units = description.units;

    read_conditions(fields, units, set);
    description.displacements_since = read_reference(fields);

    const std::filesystem::path surface = path_inside(fields, "rest_surface", set.folder);
    set.regions = read_material_regions(fields, units.length, set.folder);
    read_rest(surface, units.length, set);
    if (!set.regions.empty())
        check_material_regions(set.regions, set.rest_surface, set.supports, fields.where("regions"));
    fields.finish();
    read_tools(fields, units, set);
    read_actuators(fields, units, set);
    return description;
}

}  // namespace palpate::identify
