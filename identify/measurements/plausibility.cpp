#include "identify/measurements/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

constexpr double least_cloud = 0.002;                         // of the body's length, which all markers span
constexpr double softest_solid = 1e-5, stiffest_solid = 2e6;  // [MPa]: gels of 10 Pa, diamond 1.2 TPa
constexpr double stiffest_block = 2e5;                        // [MPa]: steel, pressed on its whole length
constexpr double least_share = 1e-9;                          // of a slender body's modulus, as a block
constexpr double off_the_guess = 300;  // mN for N, or m for mm, is 1,000 and more; a poor guess is less

/// The marker that was read furthest from where it rests, and the stiffest answer of a state to its forces.
struct Extremes {
    double moved = 0;     // [mm]
    std::string where;    // that marker
    double stiffest = 0;  // force over the largest displacement of its state [N/mm]
    double softest = std::numeric_limits<double>::infinity();
};

/// The longest side of the box round the markers [mm].
double extent_of_markers(const MeasurementSet& set) {
    if (set.markers.empty()) return 0;
    Points places(std::ssize(set.markers), 3);
    for (Eigen::Index m = 0; m < places.rows(); ++m) places.row(m) = set.markers[static_cast<std::size_t>(m)].rest;
    return mesh::bounding_box(places).longest_side();
}

Extremes extremes_of(const MeasurementSet& set) {
    Extremes extremes;
    for (const LoadState& state : set.states) {
        double moved = 0, force = 0;
        for (const Reading& reading : state.readings) {
            if (reading.marker < 0) continue;
            const Marker& marker = set.markers[reading.marker];
            const double distance = known_part(reading.position - marker.rest).norm();
            moved = std::max(moved, distance);
            if (distance > extremes.moved) {
                extremes.moved = distance;
                extremes.where =
                    fmt::format("marker {} in probe {} at time {}", label_of(marker), state.probe, state.time);
            }
        }
        for (const mesh::Contact& contact : state.contacts) force += contact.force.norm();
        for (const ReactionReading& reading : state.reactions) force += known_part(reading.force).norm();
        for (const mesh::ToolMotion& motion : state.motions)
            moved = std::max(moved, known_part(motion.translation).norm());
        if (force > 0 && moved > 0) {
            extremes.stiffest = std::max(extremes.stiffest, force / moved);
            extremes.softest = std::min(extremes.softest, force / moved);
        }
    }
    return extremes;
}

}  // namespace

std::string implausible_size(double longest) {
    constexpr double least = 1, most = 1e4;  // [mm]: what is pressed with forces that are read
    if (longest >= least && longest <= most) return {};
    return fmt::format(
        "The body is {:g} mm at its longest, {} than anything that is usually pressed and read: is its file in {}? "
        "(--unit or --longest, or 'units' in set.yaml)",
        longest, longest < least ? "smaller" : "larger", longest < least ? "m or cm" : "micrometres");
}

std::vector<std::string> implausible(const MeasurementSet& set) {
    std::vector<std::string> words;
    const double size = mesh::bounding_box(set.rest_surface.vertices).longest_side();
    if (std::string strange = implausible_size(size); !strange.empty()) words.push_back(std::move(strange));
    if (const double cloud = extent_of_markers(set); set.markers.size() > 2 && cloud < least_cloud * size) {
        words.push_back(fmt::format(
            "All {} markers lie within {:.3g} mm of each other, and the body is {:.3g} mm long: is markers.csv in "
            "another unit than units.length of set.yaml says?",
            set.markers.size(), cloud, size));
    }
    const Extremes extremes = extremes_of(set);
    if (extremes.moved > size) {
        words.push_back(
            fmt::format("{} was read {:.3g} mm from where it rests, and the body is {:.3g} mm long: are markers.csv, "
                        "positions.csv and the rest surface in one unit and one frame?",
                        extremes.where, extremes.moved, size));
    }
    // pressed as a block, E is about F / (u L); a slender body bends by far more
    if (extremes.stiffest / size > stiffest_block) {
        words.push_back(fmt::format(
            "Forces of {:.3g} N for each mm of displacement are more than a block of steel of {:.3g} mm would "
            "ask for: is units.force 'mN', or are positions in m?",
            extremes.stiffest, size));
    }
    if (extremes.softest / size < softest_solid * least_share) {
        words.push_back(
            fmt::format("Forces of {:.3g} N for each mm of displacement are less than any solid of {:.3g} mm would "
                        "ask for: are forces in N, and positions in mm?",
                        extremes.softest, size));
    }
    return words;
}

std::string implausible_modulus(double young, const MeasurementSet& set) {
    if (!(young > softest_solid && young < stiffest_solid)) {
        return fmt::format(
            "A Young's modulus of {:.3g} MPa is that of no solid: are forces in N (not mN), lengths in mm "
            "(not m)? See 'units' in set.yaml.",
            young);
    }
    const double declared = set.material ? set.material->young : missing;
    const double off = young / declared;
    if (off > off_the_guess || off < 1 / off_the_guess) {
        return fmt::format(
            "Young's modulus is {:.3g} MPa by the fit and {:.3g} MPa by set.yaml, {:.3g} times that: is one of them in "
            "kPa, or are forces in mN, or lengths in m? See 'units' in set.yaml.",
            young, declared, off);
    }
    return {};
}

}  // namespace palpate::identify
