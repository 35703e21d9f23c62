#include "identify/measurements/files/rig/regions_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/measurements/files/path_inside.h"
#include "identify/measurements/files/rig/rig_yaml.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/regions/check_regions.h"

namespace palpate::identify {
namespace {

using mesh::MaterialRegion;
using mesh::YamlFields;

constexpr double tonne_per_mm3 = 1e-12;  // one kg/m^3

bool tells(const YamlFields& item, const std::string& key) { return item.has(key) && !item.is_null(key); }

std::optional<double> read_young(const YamlFields& item, const std::string& name) {
    if (!item.has("young"))
        throw InvalidInput(
            fmt::format("{}: region '{}' tells no material. Give 'young' in MPa, or 'young: null' to have it "
                        "identified.",
                        item.where("name"), name));
    if (item.is_null("young")) return std::nullopt;
    return item.number("young", 1e-9, 1e9);  // MPa; diamond has 1.2e6
}

std::optional<double> read_poisson(const YamlFields& item) {
    if (!tells(item, "poisson")) return std::nullopt;
    const double poisson = item.number("poisson");
    if (poisson <= -1 || poisson >= 0.5)
        throw InvalidInput(fmt::format("{}: {} must lie between -1 and 0.5, both excluded (0.499 for rubber).",
                                       item.where("poisson"), poisson));
    return poisson;
}

/// The surface, or the label that stands for it until the body's file is read.
void read_place(const YamlFields& item, double unit, const std::filesystem::path& folder, RegionFiles files,
                MaterialRegion& region) {
    if (item.has("label") == item.has("surface"))
        throw InvalidInput(
            fmt::format("{}: region '{}' has {}: name the file of a closed surface inside the body, or the label that "
                        "the body's own file (an image of labels, a mesh with materials) gives it.",
                        item.where("name"), region.name,
                        item.has("label") ? "both 'label' and 'surface'" : "neither 'surface' nor 'label'"));
    constexpr int most = std::numeric_limits<int>::max();
    if (item.has("label")) {
        region.label = item.integer("label", -most, most);
        return;
    }
    region.file =
        files == RegionFiles::inside_folder ? path_inside(item, "surface", folder) : folder / item.text("surface");
    region.surface =
        read_closed_surface(region.file, unit, item.where("surface"), fmt::format("the region '{}'", region.name));
}

MaterialRegion read_region(const YamlFields& item, double unit, const std::filesystem::path& folder, RegionFiles files,
                           const std::vector<std::string>& taken) {
    MaterialRegion region{.name = read_own_name(item, taken)};
    read_place(item, unit, folder, files, region);
    region.young = read_young(item, region.name);
    region.poisson = read_poisson(item);
    // A density in another unit than kg/m^3 is far outside: air has 1, the heaviest metal 22,600.
    if (tells(item, "density")) region.density = item.number("density", 1, 30000) * tonne_per_mm3;
    item.finish();
    return region;
}

}  // namespace

std::vector<MaterialRegion> read_material_regions(const YamlFields& yaml, double unit,
                                                  const std::filesystem::path& folder, RegionFiles files) {
    std::vector<MaterialRegion> regions;
    if (!yaml.has("regions")) return regions;
    std::vector<std::string> taken;
    for (const YamlFields& item : yaml.mappings("regions")) {
        MaterialRegion region = read_region(item, unit, folder, files, taken);
        const auto same = std::ranges::find(regions, region.label, &MaterialRegion::label);
        if (region.label && same != regions.end())
            throw InvalidInput(fmt::format("{}: label {} is that of region '{}' already; each region needs its own.",
                                           item.where("label"), *region.label, same->name));
        taken.push_back(region.name);
        regions.push_back(std::move(region));
    }
    return regions;
}

void check_material_regions(const std::vector<MaterialRegion>& regions, const mesh::Surface& body,
                            const std::vector<mesh::Region>& supports, const std::string& where) {
    mesh::check_regions(regions, body, where);
    for (const MaterialRegion& region : regions) {
        const std::vector<char> held = mesh::contains(supports, region.surface.vertices);
        if (region.young || std::ranges::count(held, 0) > 0) continue;
        throw InvalidInput(
            fmt::format("{}: region '{}' lies in the supports altogether, so that no reading tells how stiff it is. "
                        "Give its 'young', or take it out.",
                        where, region.name));
    }
}

std::string regions_to_yaml(const std::filesystem::path& folder, const std::vector<MaterialRegion>& regions) {
    std::string text =
        regions.empty() ? "" : "regions:  # of materials of their own; young: null is to be identified\n";
    int number = 0;
    for (const MaterialRegion& region : regions) {
        const std::string file = fmt::format("region_{}.vtp", ++number);
        mesh::write_vtp(folder / file, region.surface);
        text += fmt::format("  - name: {}\n    surface: {}\n    young: {}\n", yaml_text(region.name), file,
                            region.young ? fmt::format("{}  # MPa", *region.young) : "null");
        if (region.poisson) text += fmt::format("    poisson: {}\n", *region.poisson);
        if (region.density)
            text += fmt::format("    density: {}  # kg/m^3\n", std::round(1e6 * *region.density / tonne_per_mm3) / 1e6);
    }
    return text;
}

}  // namespace palpate::identify
