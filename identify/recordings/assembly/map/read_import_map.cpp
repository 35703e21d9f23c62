#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <numbers>

#include "identify/measurements/files/rig/rig_yaml.h"
#include "identify/measurements/files/set_description.h"
#include "identify/measurements/files/set_units.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "identify/recordings/assembly/map/map_entries.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "mesh/text/csv_table.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;
using mesh::YamlFields;

ClockRule read_clock(const YamlFields& yaml) {
    ClockRule rule;
    if (!yaml.has("clock")) return rule;
    const YamlFields clock = yaml.mapping("clock");
    const int ways = clock.has("trigger") + clock.has("common") + clock.has("lag");
    if (ways > 1)
        throw InvalidInput(
            fmt::format("{}: {} ways to merge clocks stand here, one is allowed: trigger: CHANNEL, common: "
                        "CHANNEL, or lag: auto or a number of seconds.",
                        yaml.where("clock"), ways));
    if (clock.has("trigger")) {
        rule.kind = ClockRule::Kind::trigger;
        rule.channel = clock.text("trigger");
        if (clock.has("edge")) rule.rising = clock.choice("edge", {"rising", "falling"}) == "rising";
        if (clock.has("level")) rule.level = clock.number("level");
    } else if (clock.has("common")) {
        rule.kind = ClockRule::Kind::common;
        rule.channel = clock.text("common");
    } else {
        if (clock.has("lag") && clock.text("lag") != "auto") rule.lag = clock.number("lag", -1e6, 1e6);
        if (clock.has("motion")) rule.motion = clock.text("motion");
        if (clock.has("force")) rule.force = clock.text("force");
    }
    clock.finish();
    return rule;
}

void read_states(const YamlFields& yaml, StateRule& rule) {
    if (yaml.has("states")) parse_states(yaml.text("states"), yaml.where("states"), rule);
    if (!yaml.has("plateaus")) return;
    const YamlFields plateaus = yaml.mapping("plateaus");
    constexpr double longest = 1e6;  // [s]
    if (plateaus.has("shortest")) rule.plateaus.shortest = plateaus.number("shortest", 1e-6, longest);
    if (plateaus.has("still")) rule.plateaus.still = plateaus.number("still", 1e-6, 0.9);
    if (plateaus.has("within")) rule.plateaus.within = plateaus.number("within", 1e-9, 1e9);
    plateaus.finish();
}

/// The turn that takes the recording's frame to the mesh's, from two of the mesh's axes as the recording sees them.
Mat3 read_axes(const YamlFields& axes, const std::string& where) {
    Mat3 frame = Mat3::Zero();  // rows: the mesh's axes in the recording's frame
    int told = 0;
    const char* names[]{"x", "y", "z"};
    for (int a = 0; a < 3; ++a) {
        if (!axes.has(names[a])) continue;
        const Vec3 axis = axes.vector(names[a]);
        if (axis.norm() == 0)
            throw InvalidInput(fmt::format("{}: an axis of length 0 has no direction.", axes.where(names[a])));
        frame.row(a) = axis.normalized().transpose();
        ++told;
    }
    if (told < 2)
        throw InvalidInput(fmt::format(
            "{}: {} axis stands here, two are needed: two of the mesh's axes, as the recording's frame sees them.",
            where, told));
    if (told == 2)
        for (int a = 0; a < 3; ++a)
            if (frame.row(a).isZero(0)) frame.row(a) = frame.row((a + 1) % 3).cross(frame.row((a + 2) % 3));
    constexpr double square = 0.02;  // of a right angle: what is read off a drawing or a photograph
    if (!(frame * frame.transpose()).isIdentity(square))
        throw InvalidInput(fmt::format("{}: the axes are not at right angles.", where));
    if (frame.determinant() < 0)
        throw InvalidInput(
            fmt::format("{}: the axes are left-handed: the recording's frame, or the mesh, is mirrored. "
                        "Turn one of them round.",
                        where));
    return Eigen::Quaterniond(frame).normalized().toRotationMatrix();
}

void read_registration(const YamlFields& yaml, const std::vector<fs::path>& folders, double unit, ImportMap& map) {
    if (yaml.has("register")) parse_register(yaml.text("register"), yaml.where("register"), folders, map);
    if (!yaml.has("frame")) return;
    const YamlFields frame = yaml.mapping("frame");
    RegisterRule& rule = map.registration;
    if (frame.has("scale")) rule.scale = frame.boolean("scale");
    if (frame.has("stand_off")) rule.stand_off = unit * frame.number("stand_off", -1e6, 1e6);
    if (frame.has("each")) rule.each = frame.choice("each", {"state"}) == "state";
    if (frame.has("x") || frame.has("y") || frame.has("z")) rule.axes = read_axes(frame, yaml.where("frame"));
    frame.finish();
}

/// "auto"; "file": where displacements count from; "first": the first state of the first probe; "none": no state; or
/// the number of a probe.
void read_rest(const YamlFields& yaml, ImportMap& map) {
    if (!yaml.has("rest")) return;
    const std::string rest = yaml.text("rest");
    if (rest == "auto") return;
    map.is_rest_of_files = rest == "file";
    if (rest == "first" || rest == "file") return;
    if (rest == "none") {
        map.is_rest_seen = false;
        return;
    }
    map.rest_probe = mesh::parse_integer(rest);
    if (!map.rest_probe)
        throw InvalidInput(fmt::format(
            "{}: {} is not allowed. Allowed: 'auto', 'file' (where displacements count from), 'first', 'none', "
            "or the number of the probe whose first state shows the body at rest.",
            yaml.where("rest"), mesh::cited(rest)));
}

std::vector<MappedFile> read_files_of(const YamlFields& yaml) {
    std::vector<MappedFile> files;
    for (const YamlFields& entry : yaml.mappings("files")) files.push_back(read_mapped_file(entry));
    if (files.empty())
        throw InvalidInput(fmt::format("{}: the list is empty; name a file that the rig wrote.", yaml.where("files")));
    return files;
}

/// The body at rest, of the map or of the command line.
void read_mesh(const YamlFields& yaml, const ReadMapOptions& options, const SetUnits& units, ImportMap& map) {
    double unit = units.length;
    if (yaml.has("mesh_unit")) unit = length_unit(yaml.choice("mesh_unit", {"mm", "cm", "m", "in"}));
    fs::path file = options.mesh;
    yaml.has("mesh");  // asked for, whichever is taken
    if (file.empty()) file = found_file(yaml.text("mesh"), options.folders, yaml.where("mesh"));
    mesh::BodyFile read = mesh::read_body(file);
    const double scale = read.is_in_mm ? 1 : unit;
    map.set.rest_surface = std::move(read.surface);
    map.set.rest_surface.vertices *= scale;
    map.set.rest_volume = std::move(read.volume);
    if (map.set.rest_volume) map.set.rest_volume->nodes *= scale;
    if (map.set.rest_surface.triangles.rows() == 0 ||
        !(mesh::bounding_box(map.set.rest_surface.vertices).longest_side() > 0))
        throw InvalidInput(fmt::format("{}: the mesh has no extent.", file.string()));
}

}  // namespace

void parse_states(const std::string& text, const std::string& where, StateRule& rule) {
    const std::string every = "every=";
    if (text == "plateaus") {
        rule.kind = StateRule::Kind::plateaus;
    } else if (text == "all") {
        rule.kind = StateRule::Kind::all;
    } else if (text.starts_with(every)) {
        std::string number = text.substr(every.size());
        double unit = 1;
        if (number.ends_with("ms")) {
            unit = 1e-3;
            number.resize(number.size() - 2);
        } else if (number.ends_with("s")) {
            number.pop_back();
        }
        const auto seconds = mesh::parse_number(number);
        if (!seconds || !(*seconds > 0))
            throw InvalidInput(
                fmt::format("{}: {} is no length of time; say every=0.1s for instance.", where, mesh::cited(text)));
        rule.kind = StateRule::Kind::every;
        rule.every = unit * *seconds;
    } else {
        throw InvalidInput(fmt::format("{}: {} is not allowed{}. Allowed: 'plateaus', 'every=0.1s', 'all'.", where,
                                       mesh::cited(text), mesh::suggestion(text, {"plateaus", "all", "every=0.1s"})));
    }
}

void parse_register(const std::string& text, const std::string& where, const std::vector<fs::path>& folders,
                    ImportMap& map) {
    RegisterRule& rule = map.registration;
    if (text == "auto") {
        rule.kind = RegisterRule::Kind::automatic;
    } else if (text == "fiducials") {
        rule.kind = RegisterRule::Kind::fiducials;
    } else if (text == "icp") {
        rule.kind = RegisterRule::Kind::surface;
    } else if (text == "none") {
        rule.kind = RegisterRule::Kind::none;
    } else if (text.ends_with(".csv")) {
        rule.kind = RegisterRule::Kind::fiducials;
        const mesh::CsvTable table(found_file(text, folders, where), {"name", "x", "y", "z"}, {}, {"name"});
        for (int row = 0; row < table.rows(); ++row)
            add_place({.name = table.name(row, "name"),
                       .at = Vec3(table.number(row, "x"), table.number(row, "y"), table.number(row, "z")),
                       .attached = {},
                       .is_marker = false},
                      table.where(row), map);
    } else {
        throw InvalidInput(
            fmt::format("{}: {} is not allowed{}. Allowed: 'auto', 'fiducials', 'icp', 'none', or a file of "
                        "name,x,y,z that ends in .csv.",
                        where, mesh::cited(text), mesh::suggestion(text, {"auto", "fiducials", "icp", "none"})));
    }
}

bool names_file(const MappedFile& entry, const std::string& name) {
    const auto star = entry.file.find('*');
    if (star == std::string::npos) return fs::path(entry.file).filename().string() == name;
    return name.starts_with(entry.file.substr(0, star)) && name.ends_with(entry.file.substr(star + 1));
}

std::vector<MappedFile> read_mapped_files(const fs::path& map) { return read_files_of(YamlFields::from_file(map)); }

ImportMap read_import_map(const fs::path& file, const ReadMapOptions& given) {
    ReadMapOptions options = given;
    options.folders.insert(options.folders.begin(), file.parent_path());
    const YamlFields yaml = YamlFields::from_file(file);
    ImportMap map;
    map.file = file;
    map.set.folder = file.parent_path();
    map.set.name = yaml.has("name") ? yaml.text("name") : file.parent_path().filename().string();
    const SetUnits units = read_units(yaml);
    read_conditions(yaml, units, map.set);
    read_mesh(yaml, options, units, map);
    read_tools(yaml, units, map.set);
    read_actuators(yaml, units, map.set);

    map.files = read_files_of(yaml);
    map.names_markers = yaml.has("markers");
    read_places(yaml, "markers", units.length, true, map);
    read_places(yaml, "fiducials", units.length, false, map);
    read_quantities(yaml, map);
    read_uses(yaml, units, map);
    map.clock = read_clock(yaml);
    read_states(yaml, map.states);
    read_registration(yaml, options.folders, units.length, map);
    read_rest(yaml, map);
    if (yaml.has("readings"))
        map.reads_displacements = yaml.choice("readings", {"positions", "displacements"}) == "displacements";
    if (map.reads_displacements && !map.is_rest_seen)
        throw InvalidInput(
            fmt::format("{}: displacements count from the state at rest, and 'rest: none' says that none is seen.",
                        yaml.where("readings")));
    yaml.finish();
    return map;
}

}  // namespace palpate::identify
