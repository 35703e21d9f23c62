#include "identify/measurements/measurement_places.h"

#include <fmt/format.h>

#include <string>

#include "identify/measurements/rest_body.h"
#include "mesh/errors.h"

namespace palpate::identify {

namespace {

[[noreturn]] void refuse(const std::string& what, const Vec3& place, double distance, double allowed,
                         const mesh::Box& body, const char* hint = "") {
    throw InvalidInput(fmt::format(
        "{} at [{:.4g}] mm lies {:.4g} mm off the rest surface, {:.4g} mm are allowed. The body reaches from [{:.4g}] "
        "to "
        "[{:.4g}] mm: are the unit (units.length in set.yaml) and the frame the same?{}",
        what, fmt::join(place, ", "), distance, allowed, fmt::join(body.min, ", "), fmt::join(body.max, ", "), hint));
}

/// [mm]
double allowed_off(const RestBody& rest) { return 0.05 * rest.box.longest_side(); }

}  // namespace

void check_contacts(const RestBody& rest, const LoadState& state, const std::string& source) {
    for (const mesh::Contact& contact : state.contacts) {
        const double distance = rest.tree.closest(contact.point).distance, allowed = contact.radius + allowed_off(rest);
        if (distance > allowed)
            refuse(fmt::format("{}: the contact of probe {} at time {}", source, state.probe, state.time),
                   contact.point, distance, allowed, rest.box);
    }
}

void check_places(const MeasurementSet& set) {
    const RestBody rest(set.rest_surface);
    const mesh::Box& body = rest.box;
    const double allowed = allowed_off(rest);

    for (const LoadState& state : set.states) check_contacts(rest, state, "probes.csv");
    for (const MotionRecording& recording : set.recordings)
        for (const LoadState& load : recording.loads) check_contacts(rest, load, "motion_probes.csv");

    for (const Marker& marker : set.markers) {
        const Vec3 place = marker.anchor.value_or(marker.rest);
        const double distance = rest.tree.closest(place).distance;
        if (distance > allowed && (marker.anchor || !rest.holds(place)))
            refuse(
                fmt::format("markers.csv: {} {}", marker.anchor ? "the anchor of marker" : "marker", label_of(marker)),
                place, distance, allowed, body,
                marker.anchor ? "" : " A marker that stands off the body is told with its anchor (ax,ay,az).");
        if (marker.anchor && (marker.rest - place).norm() > body.longest_side())
            throw InvalidInput(
                fmt::format("markers.csv: marker {} at [{:.4g}] mm stands {:.4g} mm off its anchor at [{:.4g}] mm, "
                            "further than the "
                            "body is long ({:.4g} mm). Are both in the same unit and frame?",
                            label_of(marker), fmt::join(marker.rest, ", "), (marker.rest - place).norm(),
                            fmt::join(place, ", "), body.longest_side()));
    }
}

}  // namespace palpate::identify
