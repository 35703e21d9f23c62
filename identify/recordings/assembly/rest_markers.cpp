#include "identify/recordings/assembly/rest_markers.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "identify/measurements/rest_body.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double on_surface = 1e-3;  // of the longest side: nearer than a marker's base is thick

/// Points that are not of the body: fiducials, and what moves tools or measures.
std::set<std::string> names_of_others(const ImportMap& map) {
    std::set<std::string> names;
    for (const MappedPlace& place : map.places)
        if (!place.is_marker) names.insert(place.name);
    for (const MappedUse& use : map.uses) names.insert(use.points.begin(), use.points.end());
    for (const MappedQuantity& quantity : map.quantities) {
        names.insert(quantity.points.begin(), quantity.points.end());
        names.insert(quantity.minus.begin(), quantity.minus.end());
    }
    return names;
}

std::vector<std::string> marker_names(const ImportMap& map, const std::vector<ProbeStates>& probes) {
    std::vector<std::string> names;
    if (map.names_markers) {
        for (const MappedPlace& place : map.places)
            if (place.is_marker) names.push_back(place.name);
        return names;
    }
    const std::set<std::string> left_out = names_of_others(map);
    for (const ProbeStates& probe : probes)
        for (const RecordedPoint& point : probe.probe->points)
            if (!left_out.contains(point.name) && std::ranges::find(names, point.name) == names.end())
                names.push_back(point.name);
    return names;
}

/// Whole numbers of their own stay; others are numbered from 1.
std::vector<int> ids_of(const std::vector<std::string>& names) {
    std::vector<int> ids;
    for (const std::string& name : names) {
        const auto number = mesh::parse_integer(name);
        if (!number || *number < 0) break;
        ids.push_back(*number);
    }
    if (ids.size() < names.size() || std::set<int>(ids.begin(), ids.end()).size() < ids.size()) {
        ids.resize(names.size());
        for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<int>(i) + 1;
    }
    return ids;
}

/// Where a marker rests, if it is known.
std::optional<Vec3> rest_place(const ImportMap& map, const RestState& rest, const RigidMotion& frame,
                               const std::string& name) {
    const auto told = std::ranges::find(map.places, name, &MappedPlace::name);
    if (told != map.places.end() && told->at) return told->at;
    const auto point = std::ranges::find(rest.probe->points, name, &RecordedPoint::name);
    if (!map.is_rest_seen || point == rest.probe->points.end()) return std::nullopt;
    Vec3 at = rest.state.points[static_cast<std::size_t>(point - rest.probe->points.begin())].at;
    if (rest.probe->is_planar) at.z() = 0;
    if (!at.allFinite()) return std::nullopt;
    return frame(at);
}

}  // namespace

std::map<std::string, int> add_markers(const ImportMap& map, const std::vector<ProbeStates>& probes,
                                       const RestState& rest, const RigidMotion& frame, MeasurementSet& set,
                                       ImportReport& report) {
    const std::vector<std::string> names = marker_names(map, probes);
    const std::vector<int> ids = ids_of(names);
    const RestBody body(set.rest_surface);
    const double near = on_surface * body.box.longest_side();
    std::map<std::string, int> index_of;
    std::string not_seen;
    int standing_off = 0;
    double highest = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto place = rest_place(map, rest, frame, names[i]);
        if (!place) {
            not_seen += fmt::format("{}{}", not_seen.empty() ? "" : ", ", mesh::cited(names[i]));
            continue;
        }
        Marker marker{.id = ids[i], .rest = *place, .anchor = {}};
        const auto told = std::ranges::find(map.places, names[i], &MappedPlace::name);
        const mesh::SurfacePoint on = body.tree.closest(*place);
        if (told != map.places.end() && told->attached)
            marker.anchor = told->attached;
        else if (on.distance > near && !(body.is_closed && body.tree.inside(*place)))
            marker.anchor = on.position;
        if (marker.anchor) {
            ++standing_off;
            highest = std::max(highest, (*place - *marker.anchor).norm());
        }
        index_of[names[i]] = static_cast<int>(set.markers.size());
        set.markers.push_back(marker);
        report.markers.push_back(names[i]);
    }
    if (!not_seen.empty())
        report.notes.push_back(
            fmt::format("Left out, as nobody knows where they rest (no place 'at' in the map, and {}): "
                        "{}.",
                        map.is_rest_seen ? "not seen in the first state" : "'rest: none'", not_seen));
    if (!names.empty() && set.markers.empty())
        throw InvalidInput(
            fmt::format("{}: no point has a place at rest: {}, and no marker has one ('at'). Say 'rest: auto', or give "
                        "the markers their places.",
                        map.file.filename().string(),
                        map.is_rest_seen ? "the first state shows none" : "the map says 'rest: none'"));
    if (standing_off > 0)
        report.notes.push_back(
            fmt::format("{} of {} markers stand off the surface, by {:.3g} mm at most; each is tied to "
                        "its nearest point (ax,ay,az).",
                        standing_off, set.markers.size(), highest));
    return index_of;
}

}  // namespace palpate::identify
