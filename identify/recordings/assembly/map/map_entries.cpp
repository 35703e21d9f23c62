#include "identify/recordings/assembly/map/map_entries.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {

namespace fs = std::filesystem;
using mesh::YamlFields;

namespace {

struct KnownUnit {
    const char* name;
    double factor;
    const char* ours;
};

constexpr double standard_gravity = 9.80665;  // [m/s^2]
constexpr KnownUnit known_units[]{{"N", 1, "N"},
                                  {"mN", 1e-3, "N"},
                                  {"kN", 1e3, "N"},
                                  {"gf", 1e-3 * standard_gravity, "N"},
                                  {"kgf", standard_gravity, "N"},
                                  {"N*mm", 1, "N*mm"},
                                  {"N*m", 1e3, "N*mm"},
                                  {"mN*m", 1, "N*mm"},
                                  {"Pa", 1e-6, "MPa"},
                                  {"kPa", 1e-3, "MPa"},
                                  {"MPa", 1, "MPa"},
                                  {"mbar", 1e-4, "MPa"},
                                  {"bar", 0.1, "MPa"},
                                  {"psi", 6.894757293e-3, "MPa"},
                                  {"mm", 1, "mm"},
                                  {"cm", 10, "mm"},
                                  {"m", 1e3, "mm"},
                                  {"in", 25.4, "mm"},
                                  {"rad", 1, "rad"},
                                  {"deg", 3.14159265358979323846 / 180, "rad"}};

Vec3 axis_of(const YamlFields& entry, const char* key) {
    const Vec3 axis = entry.vector(key);
    if (axis.norm() == 0)
        throw InvalidInput(fmt::format("{}: an axis of length 0 has no direction; give one.", entry.where(key)));
    return axis.normalized();
}

template <class Items>
int target_of(const YamlFields& entry, const char* key, const Items& items) {
    std::vector<std::string> names;
    names.reserve(items.size());
    for (const auto& item : items) names.push_back(item.name);
    if (names.empty())
        throw InvalidInput(
            fmt::format("{}: the map has no '{}s'; describe there what this is of.", entry.where(key), key));
    const std::string chosen = entry.choice(key, names);
    return static_cast<int>(std::ranges::find(names, chosen) - names.begin());
}

/// Channel, factor, offset and sigma.
void read_channel(const YamlFields& entry, const SetUnits& units, double unit, MappedUse& use) {
    use.where = entry.where(entry.has("channel") ? "channel" : entry.has("points") ? "points" : "channel");
    if (!use.points.empty()) return;
    use.channel = entry.text("channel");
    if (entry.has("scale")) use.scale = entry.number("scale", -1e12, 1e12);
    if (entry.has("offset")) use.offset = unit * entry.number("offset", -1e12, 1e12);
    if (entry.has("sigma")) use.sigma = unit * entry.number("sigma", 1e-13 / unit, 1e12);
    if (entry.has("tare")) use.tare = entry.boolean("tare");
    if (use.kind == MappedUse::Kind::actuation && entry.has("spool"))
        use.scale /= units.length * entry.number("spool", 1e-6, 1e6);  // a torque over its radius is a tension
}

void read_axis(const YamlFields& entry, MappedUse& use) {
    use.is_about = entry.has("about");
    if (use.is_about && entry.has("along"))
        throw InvalidInput(
            fmt::format("{}: 'along' and 'about' both stand here; a channel has one axis.", entry.where("along")));
    use.axis = axis_of(entry, use.is_about ? "about" : "along");
}

MappedUse read_force(const YamlFields& entry, const SetUnits& units) {
    MappedUse use;
    use.kind = MappedUse::Kind::force;
    read_channel(entry, units, units.force, use);
    use.axis = axis_of(entry, "along");
    use.at = units.length * entry.vector("at");
    if (entry.has("radius")) use.radius = units.length * entry.number("radius", 0, 1e9);
    return use;
}

MappedUse read_motion(const YamlFields& entry, const SetUnits& units, const MeasurementSet& set) {
    MappedUse use;
    use.kind = MappedUse::Kind::motion;
    use.target = target_of(entry, "tool", set.tools);
    if (entry.has("points")) {
        use.points = entry.texts("points");
        if (use.points.empty() || entry.has("channel"))
            throw InvalidInput(
                fmt::format("{}: a tool is moved as points are, or as a channel tells: name one point at "
                            "least, or a channel.",
                            entry.where("points")));
        if (entry.has("turns")) use.turns = entry.boolean("turns");
    } else {
        read_axis(entry, use);
    }
    read_channel(entry, units, use.is_about ? units.angle : units.length, use);
    if (entry.has("free"))
        for (const std::string& axis : entry.texts("free")) {
            const auto at = std::string("xyz").find(axis);
            if (axis.size() != 1 || at == std::string::npos)
                throw InvalidInput(
                    fmt::format("{}: {} is no coordinate; x, y and z are.", entry.where("free"), mesh::cited(axis)));
            use.free.push_back(static_cast<int>(at));
        }
    return use;
}

MappedUse read_reaction(const YamlFields& entry, const SetUnits& units, const MeasurementSet& set) {
    MappedUse use;
    use.kind = MappedUse::Kind::reaction;
    use.target = target_of(entry, "tool", set.tools);
    read_axis(entry, use);
    read_channel(entry, units, use.is_about ? units.moment : units.force, use);
    constexpr double along_axis = 1e-6;  // rounding of a direction that was typed and normalised
    if (use.axis.cwiseAbs().maxCoeff() < 1 - along_axis)
        throw InvalidInput(
            fmt::format("{}: [{:.3g}] is oblique, and a set tells reactions along its frame's axes. Turn the "
                        "mesh so that the load cell reads along one.",
                        entry.where(use.is_about ? "about" : "along"), fmt::join(use.axis, ", ")));
    return use;
}

MappedUse read_actuation(const YamlFields& entry, const SetUnits& units, const MeasurementSet& set) {
    MappedUse use;
    use.kind = MappedUse::Kind::actuation;
    use.target = target_of(entry, "actuator", set.actuators);
    const bool is_pressure =
        std::holds_alternative<mesh::PressureActuator>(set.actuators[static_cast<std::size_t>(use.target)].kind);
    read_channel(entry, units, is_pressure ? units.pressure : units.force, use);
    return use;
}

}  // namespace

fs::path found_file(const std::string& name, const std::vector<fs::path>& folders, const std::string& where) {
    std::string sought;
    for (const fs::path& folder : folders) {
        const fs::path file = folder / name;
        if (fs::is_regular_file(file)) return file;
        sought += fmt::format("{}'{}'", sought.empty() ? "" : ", ", (folder.empty() ? fs::path(".") : folder).string());
    }
    throw IoError(
        fmt::format("{}: there is no file {} in {}. Name its folder on the command line, or correct the name.", where,
                    mesh::cited(name), sought));
}

double length_unit(const std::string& name) { return name == "mm" ? 1 : name == "cm" ? 10 : name == "m" ? 1000 : 25.4; }

MappedValue parse_value(const std::string& name, const std::string& text, const std::string& where) {
    const auto cut = text.find_first_of(" \t");
    const auto number = mesh::parse_number(text.substr(0, cut));
    if (!number)
        throw InvalidInput(fmt::format("{}: {} is no number; say '10 kPa' for instance.", where, mesh::cited(text)));
    if (cut == std::string::npos) return {name, *number, ""};
    const std::string unit = text.substr(text.find_first_not_of(" \t", cut));
    const auto* known = std::ranges::find(known_units, unit, &KnownUnit::name);
    if (known == std::end(known_units)) {
        std::vector<std::string> names;
        names.reserve(std::size(known_units));
        for (const KnownUnit& each : known_units) names.emplace_back(each.name);
        throw InvalidInput(fmt::format("{}: {} is no unit that is known here{}. Known: {}.", where, mesh::cited(unit),
                                       mesh::suggestion(unit, names), mesh::listed(names)));
    }
    return {name, *number * known->factor, known->ours};
}

MappedFile read_mapped_file(const YamlFields& entry) {
    MappedFile file;
    file.file = entry.text("file");
    file.where = entry.where("file");
    file.how = read_file_map(entry);
    if (entry.has("probe")) file.probe = entry.integer("probe", 0, 1'000'000'000);
    if (entry.has("values"))
        for (const YamlFields& value : entry.mapping_or_mappings("values")) {
            const std::string name = value.text("name");
            file.values.push_back(parse_value(name, value.text("value"), value.where("value")));
            value.finish();
        }
    if (entry.has("while")) file.values_act_always = entry.choice("while", {"moved", "always"}) == "always";
    if (entry.has("order")) file.is_unordered = entry.choice("order", {"known", "unknown"}) == "unknown";
    entry.finish();
    return file;
}

void add_place(MappedPlace place, const std::string& where, ImportMap& map) {
    if (std::ranges::find(map.places, place.name, &MappedPlace::name) != map.places.end())
        throw InvalidInput(
            fmt::format("{}: the point {} stands in the map already. Keep one.", where, mesh::cited(place.name)));
    map.places.push_back(std::move(place));
}

void read_places(const YamlFields& yaml, const char* key, double unit, bool are_markers, ImportMap& map) {
    if (!yaml.has(key)) return;
    for (const YamlFields& entry : yaml.mappings(key)) {
        MappedPlace place{.name = entry.text("name"), .at = {}, .attached = {}, .is_marker = are_markers};
        if (!are_markers || entry.has("at")) place.at = unit * entry.vector("at");
        if (are_markers && entry.has("attached")) place.attached = unit * entry.vector("attached");
        add_place(std::move(place), entry.where("name"), map);
        entry.finish();
    }
}

void read_quantities(const YamlFields& yaml, ImportMap& map) {
    if (!yaml.has("quantities")) return;
    for (const YamlFields& entry : yaml.mappings("quantities")) {
        MappedQuantity quantity{.name = entry.text("name"), .points = entry.texts("points"), .minus = {}};
        if (entry.has("minus")) quantity.minus = entry.texts("minus");
        if (quantity.points.empty())
            throw InvalidInput(fmt::format("{}: the list is empty; name a point.", entry.where("points")));
        quantity.along = axis_of(entry, "along");
        entry.finish();
        map.quantities.push_back(std::move(quantity));
    }
}

void read_uses(const YamlFields& yaml, const SetUnits& units, ImportMap& map) {
    const auto read = [&](const char* key, const auto& one) {
        if (!yaml.has(key)) return;
        for (const YamlFields& entry : yaml.mappings(key)) {
            map.uses.push_back(one(entry));
            entry.finish();
        }
    };
    read("forces", [&](const YamlFields& entry) { return read_force(entry, units); });
    read("motions", [&](const YamlFields& entry) { return read_motion(entry, units, map.set); });
    read("reactions", [&](const YamlFields& entry) { return read_reaction(entry, units, map.set); });
    read("actuations", [&](const YamlFields& entry) { return read_actuation(entry, units, map.set); });
}

}  // namespace palpate::identify
