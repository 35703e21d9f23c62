#include "identify/measurements/files/set_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "mesh/supports/region_yaml.h"

namespace palpate::identify {

using mesh::YamlFields;

namespace {

constexpr const char* format_name = "palpate-measurements/1";

SetUnits read_units(const YamlFields& fields) {
    static const std::map<std::string, double> lengths{{"mm", 1}, {"cm", 10}, {"m", 1000}};
    static const std::map<std::string, double> forces{{"N", 1}, {"mN", 1e-3}};
    SetUnits units;
    if (!fields.has("units")) return units;
    const YamlFields given = fields.mapping("units");
    if (given.has("length")) units.length = lengths.at(given.choice("length", {"mm", "cm", "m"}));
    if (given.has("force")) units.force = forces.at(given.choice("force", {"N", "mN"}));
    if (given.has("time")) given.choice("time", {"s"});
    given.finish();
    return units;
}

/// A file of the set: a set that was received from elsewhere must not reach out of its folder.
std::filesystem::path path_inside(const YamlFields& fields, const std::string& key,
                                  const std::filesystem::path& folder) {
    const std::filesystem::path path = fields.text(key);
    const bool climbs = std::ranges::find(path, std::filesystem::path("..")) != path.end();
    if (path.empty() || path.is_absolute() || climbs)
        throw InvalidInput(
            fmt::format("{}: '{}' leads out of the set's folder. Copy the file into the folder and name "
                        "it by its path there.",
                        fields.where(key), path.string()));
    if (!std::filesystem::is_regular_file(folder / path))
        throw IoError(fmt::format("{}: there is no file '{}'.", fields.where(key), (folder / path).string()));
    return folder / path;
}

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

}  // namespace

SetUnits read_set_description(const std::filesystem::path& file, MeasurementSet& set) {
    const YamlFields fields = YamlFields::from_file(file);
    if (const std::string format = fields.text("format"); format != format_name)
        throw InvalidInput(fmt::format("{}: '{}' is not a format that is read here. Only '{}' is.",
                                       fields.where("format"), format, format_name));
    set.folder = file.parent_path();
    set.name = fields.has("name") ? fields.text("name") : std::filesystem::absolute(set.folder).filename().string();
    const SetUnits units = read_units(fields);

    for (const YamlFields& support : fields.mappings("supports"))
        if (support.has("points") && support.mapping("points").has("file"))
            path_inside(support.mapping("points"), "file", set.folder);
    set.supports = mesh::read_regions(fields, "supports", units.length);

    // A density in another unit than kg/m^3 is far outside: air has 1, the heaviest metal 22,600.
    if (fields.has("density")) set.density = fields.number("density", 1, 30000) / 1e12;  // kg/m^3 in tonne/mm^3
    if (fields.has("history")) set.continuous = fields.choice("history", {"fresh", "continuous"}) == "continuous";
    if (fields.has("gravity")) set.gravity = units.length * fields.vector("gravity");
    if (fields.has("noise")) {
        const YamlFields noise = fields.mapping("noise");
        if (noise.has("position"))
            set.position_noise = units.length * noise.number("position", least_position_noise / units.length, 1e6);
        if (noise.has("force"))
            set.force_noise = units.force * noise.number("force", least_force_noise / units.force, 1e9);
        noise.finish();
    }
    if (fields.has("material")) set.material = read_material(fields.mapping("material"));

    const std::filesystem::path surface = path_inside(fields, "rest_surface", set.folder);
    fields.finish();
    mesh::BodyFile rest = mesh::read_body(surface);
    const double scale = rest.is_in_mm ? 1 : units.length;
    set.rest_surface = std::move(rest.surface);
    set.rest_surface.vertices *= scale;
    set.rest_volume = std::move(rest.volume);
    if (set.rest_volume) set.rest_volume->nodes *= scale;
    return units;
}

}  // namespace palpate::identify
