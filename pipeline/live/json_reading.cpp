#include "pipeline/live/json_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr const char* example =
    R"({"probe": 3, "time": 0, "contacts": [{"at": [1, 2, 3], "force": [0, 0, -1]}], "markers": {"1": [4, 5, 6]}})";

InvalidInput refused(const std::string& where, const std::string& what) {
    return InvalidInput(fmt::format("{}: {}. A reading is a line as {}", where, what, example));
}

double number(const json& value, const std::string& where, const char* what, bool may_be_missing) {
    if (value.is_null() && may_be_missing) return identify::missing;
    if (!value.is_number()) throw refused(where, fmt::format("{} is {}, which is no number", what, value.dump()));
    return value.get<double>();
}

Vec3 vector(const json& value, const std::string& where, const char* what, bool may_be_missing = false) {
    if (!value.is_array() || value.size() != 3) {
        throw refused(where, fmt::format("{} is {}, not three numbers", what, value.dump()));
    }
    return {number(value[0], where, what, may_be_missing), number(value[1], where, what, may_be_missing),
            number(value[2], where, what, may_be_missing)};
}

const json& member(const json& object, const char* name, const std::string& where) {
    if (!object.contains(name)) throw refused(where, fmt::format("'{}' is missing", name));
    return object.at(name);
}

}  // namespace

identify::LoadState read_json_reading(const std::string& line, const identify::MeasurementSet& set,
                                      const std::string& where) {
    json object;
    try {
        object = json::parse(line);
    } catch (const json::exception&) {
        throw refused(where, fmt::format("'{:.60}' is no JSON", line));
    }
    if (!object.is_object()) throw refused(where, fmt::format("'{:.60}' is no JSON object", line));
    identify::LoadState state;
    const json& probe = member(object, "probe", where);
    if (!probe.is_number_integer()) throw refused(where, fmt::format("probe is {}, no whole number", probe.dump()));
    state.probe = probe.get<int>();
    state.time = object.contains("time") ? number(object["time"], where, "time", false) : 0;
    for (const json& contact : object.value("contacts", json::array())) {
        const double radius = contact.contains("radius") ? number(contact["radius"], where, "radius", false) : 0;
        state.contacts.push_back({vector(member(contact, "at", where), where, "at"),
                                  vector(member(contact, "force", where), where, "force"), radius});
    }
    const json& markers = member(object, "markers", where);
    if (!markers.is_object()) throw refused(where, "markers is no object of names and places");
    for (const auto& [name, place] : markers.items()) {
        const auto found = std::ranges::find(set.markers, name, &identify::label_of);
        if (found == set.markers.end()) throw refused(where, fmt::format("marker '{}' is not in markers.csv", name));
        state.readings.push_back({static_cast<int>(found - set.markers.begin()),
                                  vector(place, where, "a marker", true),
                                  identify::missing,
                                  {}});
    }
    return state;
}

}  // namespace palpate::pipeline
