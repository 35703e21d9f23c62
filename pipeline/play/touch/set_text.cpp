#include "pipeline/play/touch/set_text.h"

#include <cmath>

#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json number(double value) { return std::isnan(value) ? json() : json(value); }
double number(const json& value) { return value.is_null() ? identify::missing : value.get<double>(); }

json vector(const Vec3& v) { return {number(v[0]), number(v[1]), number(v[2])}; }
Vec3 vector(const json& list, std::size_t first = 0) {
    return {number(list.at(first)), number(list.at(first + 1)), number(list.at(first + 2))};
}

double rounded(double length) { return std::round(length * 1e6) / 1e6; }

json as_text(const identify::LoadState& state) {
    json contacts = json::array(), readings = json::array();
    for (const mesh::Contact& c : state.contacts) {
        contacts.push_back({c.point[0], c.point[1], c.point[2], c.force[0], c.force[1], c.force[2], c.radius});
    }
    for (const identify::Reading& r : state.readings) {
        json reading = {r.marker};
        for (const double x : r.position) reading.push_back(number(rounded(x)));
        readings.push_back(reading);
    }
    json text = {{"probe", state.probe},
                 {"time", state.time},
                 {"contacts", contacts},
                 {"readings", readings},
                 {"gravity", vector(state.gravity)},
                 {"pressure", number(state.pressure)}};
    for (const identify::Actuation& one : state.actuations) text["settings"].push_back({one.actuator, one.value});
    return text;
}

identify::LoadState from_text(const json& text) {
    identify::LoadState state;
    state.probe = text.at("probe").get<int>();
    state.time = text.at("time").get<double>();
    for (const json& c : text.at("contacts")) state.contacts.push_back({vector(c), vector(c, 3), number(c.at(6))});
    for (const json& r : text.at("readings")) {
        state.readings.push_back({.marker = r.at(0).get<int>(), .position = vector(r, 1)});
    }
    state.gravity = vector(text.at("gravity"));
    state.pressure = number(text.at("pressure"));
    for (const json& one : text.value("settings", json::array()))
        state.actuations.push_back({.actuator = one.at(0).get<int>(), .value = number(one.at(1))});
    return state;
}

}  // namespace

json set_as_text(const identify::MeasurementSet& set) {
    json text = {{"name", set.name},
                 {"continuous", set.continuous},
                 {"gravity", set.gravity ? vector(*set.gravity) : json()},
                 {"markers", json::array()},
                 {"states", json::array()}};
    for (const identify::Marker& marker : set.markers) {
        json one = {marker.id, marker.rest[0], marker.rest[1], marker.rest[2]};
        if (marker.anchor) {
            for (const double x : *marker.anchor) one.push_back(x);
        }
        text["markers"].push_back(one);
    }
    for (const identify::LoadState& state : set.states) text["states"].push_back(as_text(state));
    return text;
}

json actuator_as_text(const mesh::Actuator& actuator) {
    if (const auto* tendon = std::get_if<mesh::TendonActuator>(&actuator.kind)) {
        json path = json::array();
        for (Eigen::Index k = 0; k < tendon->path.rows(); ++k) path.push_back(vector(Vec3(tendon->path.row(k))));
        return {{"name", actuator.name}, {"kind", tendon->by_length ? "length" : "tension"}, {"path", path}};
    }
    const auto* point = std::get_if<Vec3>(&std::get<mesh::PressureActuator>(actuator.kind).cavity);
    if (!point) throw InvalidInput(actuator.name + ": a cavity is played by a point of its wall");
    return {{"name", actuator.name}, {"kind", "pressure"}, {"at", vector(*point)}};
}

mesh::Actuator actuator_from_text(const json& text) {
    mesh::Actuator actuator{text.at("name").get<std::string>(), {}};
    const auto kind = text.at("kind").get<std::string>();
    if (kind == "pressure") {
        actuator.kind = mesh::PressureActuator{vector(text.at("at"))};
        return actuator;
    }
    const json& path = text.at("path");
    mesh::TendonActuator tendon{Points(std::ssize(path), 3), kind == "length"};
    for (std::size_t k = 0; k < path.size(); ++k)
        tendon.path.row(static_cast<Eigen::Index>(k)) = vector(path[k]).transpose();
    actuator.kind = std::move(tendon);
    return actuator;
}

identify::MeasurementSet set_from_text(const json& text) {
    identify::MeasurementSet set;
    set.name = text.at("name").get<std::string>();
    set.continuous = text.at("continuous").get<bool>();
    if (!text.at("gravity").is_null()) set.gravity = vector(text.at("gravity"));
    for (const json& one : text.at("markers")) {
        identify::Marker marker{.id = one.at(0).get<int>(), .rest = vector(one, 1), .anchor = {}};
        if (one.size() > 4) marker.anchor = vector(one, 4);
        set.markers.push_back(marker);
    }
    for (const json& state : text.at("states")) set.states.push_back(from_text(state));
    return set;
}

}  // namespace palpate::pipeline
