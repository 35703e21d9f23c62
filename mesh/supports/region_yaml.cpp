#include "mesh/supports/region_yaml.h"

#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/csv_table.h"

namespace palpate::mesh {
namespace {

constexpr double largest_length = 1e12;  // [unit of the file]: whatever is larger is a slip

Region read_box(const YamlFields& yaml, double unit) {
    const BoxRegion box{unit * yaml.vector("min"), unit * yaml.vector("max")};
    if (!(box.min.array() <= box.max.array()).all()) {
        throw InvalidInput(
            fmt::format("{}: the box's max is below its min in some direction; swap them there", yaml.where("max")));
    }
    yaml.finish();
    return box;
}

Region read_sphere(const YamlFields& yaml, double unit) {
    const SphereRegion sphere{unit * yaml.vector("center"), unit * yaml.number("radius", 0, largest_length)};
    yaml.finish();
    return sphere;
}

Region read_plane(const YamlFields& yaml, double unit) {
    const PlaneRegion plane{unit * yaml.vector("point"), yaml.vector("normal"),
                            unit * yaml.number("within", 0, largest_length)};
    if (plane.normal.norm() == 0) {
        throw InvalidInput(fmt::format("{}: a normal of length 0 has no direction; give one", yaml.where("normal")));
    }
    yaml.finish();
    return plane;
}

Points read_points(const std::filesystem::path& file, double unit) {
    const CsvTable table(file, {"x", "y", "z"});
    Points points(table.rows(), 3);
    for (int row = 0; row < table.rows(); ++row) {
        points.row(row) << table.number(row, "x"), table.number(row, "y"), table.number(row, "z");
    }
    return unit * points;
}

Region read_point_cloud(const YamlFields& yaml, double unit) {
    PointsRegion region;
    if (yaml.has("at")) {
        const std::vector<Vec3> at = yaml.vectors("at");
        region.points.resize(static_cast<Eigen::Index>(at.size()), 3);
        for (std::size_t i = 0; i < at.size(); ++i) region.points.row(static_cast<Eigen::Index>(i)) = unit * at[i];
    } else {
        region.points = read_points(yaml.file().parent_path() / yaml.text("file"), unit);
    }
    region.within = unit * yaml.number("within", 0, largest_length);
    if (yaml.has("joined")) region.joined = unit * yaml.number("joined", 0, largest_length);
    yaml.finish();
    return region;
}

std::string list(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string reach_of(const PointsRegion& r) {
    return fmt::format("within: {}", r.within) + (r.joined >= 0 ? fmt::format(", joined: {}", r.joined) : "");
}

struct ToYaml {
    std::string operator()(const BoxRegion& r) const {
        return fmt::format("box: {{min: {}, max: {}}}", list(r.min), list(r.max));
    }
    std::string operator()(const SphereRegion& r) const {
        return fmt::format("sphere: {{center: {}, radius: {}}}", list(r.center), r.radius);
    }
    std::string operator()(const PlaneRegion& r) const {
        return fmt::format("plane: {{point: {}, normal: {}, within: {}}}", list(r.point), list(r.normal), r.within);
    }
    std::string operator()(const PointsRegion& r) const {
        std::string at;
        for (Eigen::Index i = 0; i < r.points.rows(); ++i) at += (i ? ", " : "") + list(r.points.row(i).transpose());
        return fmt::format("points: {{at: [{}], {}}}", at, reach_of(r));
    }
};

}  // namespace

Region read_region(const YamlFields& yaml, double unit) {
    constexpr std::array kinds{"box", "sphere", "plane", "points"};
    std::string kind;
    for (const char* candidate : kinds) {
        if (!yaml.has(candidate)) continue;
        if (!kind.empty()) {
            throw InvalidInput(
                fmt::format("{}: one region is named '{}' and '{}'; begin a new '- ' item for the second",
                            yaml.where(candidate), kind, candidate));
        }
        kind = candidate;
    }
    if (kind.empty()) {
        yaml.finish();
        throw InvalidInput(fmt::format("{}: a region is a box, sphere, plane or points", yaml.where("")));
    }
    const YamlFields fields = yaml.mapping(kind);
    yaml.finish();
    if (kind == "box") return read_box(fields, unit);
    if (kind == "sphere") return read_sphere(fields, unit);
    if (kind == "plane") return read_plane(fields, unit);
    return read_point_cloud(fields, unit);
}

std::vector<Region> read_regions(const YamlFields& yaml, const std::string& key, double unit) {
    std::vector<Region> regions;
    for (const YamlFields& item : yaml.mappings(key)) regions.push_back(read_region(item, unit));
    if (regions.empty()) {
        throw InvalidInput(
            fmt::format("{}: the list is empty; a body must be held somewhere: give a box, sphere, plane or points",
                        yaml.where(key)));
    }
    return regions;
}

std::string regions_to_yaml(const std::vector<Region>& regions, const std::string& indent) {
    std::string text;
    for (const Region& region : regions) text += indent + "- " + std::visit(ToYaml{}, region) + "\n";
    return text;
}

std::string regions_to_yaml_in(const std::filesystem::path& folder, const std::vector<Region>& regions,
                               const std::string& name, const std::string& indent) {
    constexpr Eigen::Index few = 20;
    std::string text;
    int files = 0;
    for (const Region& region : regions) {
        const auto* cloud = std::get_if<PointsRegion>(&region);
        if (!cloud || cloud->points.rows() <= few) {
            text += regions_to_yaml({region}, indent);
            continue;
        }
        std::string table = "x,y,z\n";
        for (const auto& point : cloud->points.rowwise())
            table += fmt::format("{},{},{}\n", point[0], point[1], point[2]);
        const std::string file = fmt::format("{}_{}.csv", name, ++files);
        write_text(folder / file, table);
        text += fmt::format("{}- points: {{file: {}, {}}}\n", indent, file, reach_of(*cloud));
    }
    return text;
}

}  // namespace palpate::mesh
