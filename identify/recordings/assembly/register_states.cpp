#include "identify/recordings/assembly/register_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/recordings/assembly/frames/surface_fit.h"
#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::identify {
namespace {

constexpr double nearly_there = 0.02;  // of the longest side: the points lie on the body as they are
constexpr double off_scale = 0.03;     // of lengths: more than a calibrated camera errs by

/// Points whose place on the mesh is known, as a state shows them.
struct Counterparts {
    Points recorded, wanted;
    std::vector<std::string> names;
};

Counterparts counterparts_in(const ImportMap& map, const ProbeRecording& probe, const ImportedState& state,
                             bool with_markers) {
    std::vector<Vec3> recorded, wanted;
    Counterparts found;
    for (const MappedPlace& place : map.places) {
        if (!place.at || (place.is_marker && !with_markers)) continue;
        const auto point = std::ranges::find(probe.points, place.name, &RecordedPoint::name);
        if (point == probe.points.end()) continue;
        Vec3 at = state.points[static_cast<std::size_t>(point - probe.points.begin())].at;
        if (probe.is_planar) at.z() = 0;
        if (!at.allFinite()) continue;
        recorded.push_back(at);
        wanted.push_back(*place.at);
        found.names.push_back(place.name);
    }
    found.recorded.resize(std::ssize(recorded), 3);
    found.wanted.resize(std::ssize(wanted), 3);
    for (std::size_t i = 0; i < recorded.size(); ++i) {
        found.recorded.row(static_cast<Eigen::Index>(i)) = recorded[i].transpose();
        found.wanted.row(static_cast<Eigen::Index>(i)) = wanted[i].transpose();
    }
    return found;
}

/// All of a state's points that were seen whole.
Points seen_in(const ProbeRecording& probe, const ImportedState& state) {
    std::vector<Vec3> seen;
    for (const SteadyPoint& point : state.points) {
        Vec3 at = point.at;
        if (probe.is_planar) at.z() = 0;
        if (at.allFinite()) seen.push_back(at);
    }
    Points points(std::ssize(seen), 3);
    for (std::size_t i = 0; i < seen.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = seen[i].transpose();
    return points;
}

Registration fit_by_names(const ImportMap& map, const Counterparts& found, bool is_planar) {
    if (map.registration.axes) return fit_shift(found.recorded, found.wanted, *map.registration.axes);
    if (is_planar) return fit_counterparts_in_plane(found.recorded, found.wanted);
    return fit_counterparts(found.recorded, found.wanted, map.registration.scale);
}

/// Lengths between points of known places against those on the mesh.
void check_scale(const ImportMap& map, const Counterparts& found, Registration& fit) {
    if (found.recorded.rows() < 2 || map.registration.scale) return;
    const auto size = [](const Points& points) {
        return std::sqrt((points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean());
    };
    const double recorded = size(found.recorded), wanted = size(found.wanted);
    if (!(recorded > 0 && wanted > 0)) return;
    const double ratio = recorded / wanted;
    if (const std::string slip = slip_of_units(ratio); !slip.empty())
        throw InvalidInput(
            fmt::format("{}: {}. Tell the unit of the files' positions (--unit m, or unit: m in the map), or "
                        "that of the mesh (mesh_unit: m).",
                        map.file.filename().string(), slip));
    if (std::abs(ratio - 1) > off_scale)
        fit.notes.push_back(
            fmt::format("Lengths between the points of known places are {:.3g} times those on the mesh: the "
                        "camera's scale is off, or places are. 'frame: {{scale: true}}' fits it.",
                        ratio));
}

void check_mirrored(const Counterparts& found, Registration& fit) {
    constexpr double clearly = 0.3;  // of what the frame as it is leaves: 1 where neither fits better. A choice
    if (found.recorded.rows() > 3 && mirrored_share(found.recorded, found.wanted) < clearly)
        fit.notes.push_back(
            "The points fit mirrored and do not as they are: the frame of the recording is left-handed, or the "
            "mesh is mirrored, or two points have exchanged names.");
}

/// Of points without counterparts: the extent has to be that of the mesh, more or less.
void check_extent(const ImportMap& map, const Points& points) {
    constexpr double too_large = 5, too_small = 0.02;  // of the mesh's: markers may sit on a small part of it
    const double size = mesh::bounding_box(points).diagonal(),
                 wanted = mesh::bounding_box(map.set.rest_surface.vertices).diagonal();
    const double ratio = size / wanted;
    if (ratio < too_large && ratio > too_small) return;
    const std::string slip = slip_of_units(ratio);
    throw InvalidInput(
        fmt::format("{}: the points reach over {:.4g} mm and the mesh over {:.4g} mm{}. Tell the unit of the "
                    "files' positions (--unit m, or unit: m in the map), or that of the mesh.",
                    map.file.filename().string(), size, wanted, slip.empty() ? "" : ": " + slip));
}

/// How far points lie off the surface, rms [mm].
double off_surface(const mesh::SurfaceTree& tree, const Points& points, double stand_off) {
    double squares = 0;
    for (const auto& point : points.rowwise())
        squares += std::pow(tree.closest(point.transpose()).distance - stand_off, 2);
    return std::sqrt(squares / static_cast<double>(std::max<Eigen::Index>(points.rows(), 1)));
}

Registration fit_by_surface(const ImportMap& map, const RestState& rest, std::string& how) {
    if (rest.probe->is_planar)
        throw InvalidInput(
            fmt::format("{}: points in a plane cannot be registered to a surface. Name two of them whose place "
                        "on the mesh is known (fiducials).",
                        map.file.filename().string()));
    const Points points = seen_in(*rest.probe, rest.state);
    if (points.rows() == 0)
        throw InvalidInput(
            fmt::format("{}: no point was seen in the first state of probe {}, so there is nothing to register "
                        "by. Say 'register: none', or name points (fiducials).",
                        map.file.filename().string(), rest.probe->probe));
    check_extent(map, points);
    const double longest = mesh::bounding_box(map.set.rest_surface.vertices).longest_side();
    const mesh::SurfaceTree tree(map.set.rest_surface);
    const double off = off_surface(tree, points, map.registration.stand_off);
    if (map.registration.kind == RegisterRule::Kind::automatic && off < nearly_there * longest) {
        how = fmt::format("nothing: the points lie {:.3g} mm rms off the surface as they are", off);
        Registration as_it_is;
        as_it_is.rms = off;
        as_it_is.points = static_cast<int>(points.rows());
        return as_it_is;
    }
    how = fmt::format("{} points on the surface", points.rows());
    return fit_surface(points, map.set.rest_surface, {.stand_off = map.registration.stand_off});
}

}  // namespace

StateFrames register_states(const ImportMap& map, const std::vector<ProbeStates>& probes, const RestState& rest,
                            ImportReport& report) {
    StateFrames frames;
    const ImportedState& first = rest.state;
    const Counterparts found = counterparts_in(map, *rest.probe, first, map.is_rest_seen);
    const RegisterRule& rule = map.registration;
    const bool is_by_names = rule.kind != RegisterRule::Kind::none && rule.kind != RegisterRule::Kind::surface &&
                             (rule.kind == RegisterRule::Kind::fiducials || rule.axes || found.recorded.rows() >= 2);
    bool has_points = false;
    for (const ProbeStates& probe : probes) has_points = has_points || !probe.probe->points.empty();
    if (!has_points) {
        report.registered_by = "nothing: no points were recorded";
    } else if (rule.kind == RegisterRule::Kind::none) {
        report.registered_by = "nothing, as the map says";
        report.registration = Registration{};
        if (rule.axes) report.registration->motion.R = *rule.axes;
    } else if (is_by_names) {
        report.registration = fit_by_names(map, found, rest.probe->is_planar);
        report.registered_by = fmt::format("{} points of known places ({}){}", found.names.size(),
                                           fmt::join(found.names, ", "), rule.axes ? ", turned as the map says" : "");
        check_scale(map, found, *report.registration);
        if (!rule.axes && !rest.probe->is_planar) check_mirrored(found, *report.registration);
    } else {
        report.registration = fit_by_surface(map, rest, report.registered_by);
    }
    const RigidMotion one = report.registration ? report.registration->motion : RigidMotion{};
    for (const ProbeStates& probe : probes)
        for (const ImportedState& state : probe.states) {
            frames.of_state.push_back(one);
            if (!rule.each || !is_by_names) continue;
            const Counterparts seen = counterparts_in(map, *probe.probe, state, false);
            frames.of_state.back() = fit_by_names(map, seen, probe.probe->is_planar).motion;
        }
    if (rule.each && is_by_names) report.registered_by += ", state by state";
    return frames;
}

}  // namespace palpate::identify
