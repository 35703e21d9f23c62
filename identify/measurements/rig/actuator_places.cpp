#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/measurements/rest_body.h"
#include "identify/measurements/rig/cavities.h"
#include "identify/measurements/rig/chambers.h"
#include "identify/measurements/rig/rig_places.h"
#include "mesh/errors.h"

namespace palpate::identify {

void check_tendon(const mesh::TendonActuator& tendon, const RestBody& body, const std::string& name,
                  const std::string& where) {
    const double allowed = 0.01 * body.box.longest_side();
    for (Eigen::Index i = 0; i < tendon.path.rows(); ++i) {
        const Vec3 point = tendon.path.row(i).transpose();
        const double distance = body.tree.closest(point).distance;
        if (body.holds(point) || distance <= allowed) continue;
        throw InvalidInput(
            fmt::format("{}: point {} of tendon '{}' at {} lies {:.4g} mm outside of the body, {:.4g} mm are "
                        "allowed. A tendon runs through the body; give its path where it enters, bends and ends, in "
                        "the unit and frame of the body.",
                        where, i + 1, name, place_in_words(point), distance, allowed));
    }
}

namespace {

/// A tendon is straight between its points, whatever the body does: one whose points are far apart leaves a body that
/// bends as the string leaves a bow.
void note_bowstring(const mesh::TendonActuator& tendon, const RestBody& body, const std::string& name,
                    std::vector<std::string>& notes) {
    // Where material next to it is strained by a tenth, a line of length L at depth d arches by L^2 / (80 d): from here
    // on by twice its depth, out of the body.
    constexpr double most = 13;  // times its depth
    for (Eigen::Index i = 1; i < tendon.path.rows(); ++i) {
        const Vec3 from = tendon.path.row(i - 1).transpose(), to = tendon.path.row(i).transpose();
        const double length = (to - from).norm(), depth = body.depth((from + to) / 2);
        if (!(depth > 0) || length <= most * depth) continue;
        notes.push_back(fmt::format(
            "Tendon '{}' runs straight for {:.3g} mm from point {} to the next, {:.0f} times as far as it "
            "lies deep: it leaves a body that bends, as a bowstring does. If it is guided, give the points where.",
            name, length, i, length / depth));
        return;
    }
}

/// Pressure in a state's cavities is told by states.csv or by actuators.
void check_known_pressure(const MeasurementSet& set) {
    const auto is_pressure = [&](const Actuation& actuation) {
        const mesh::Actuator& actuator = set.actuators[static_cast<std::size_t>(actuation.actuator)];
        return std::holds_alternative<mesh::PressureActuator>(actuator.kind);
    };
    for (const LoadState& state : set.states) {
        if (std::isnan(state.pressure)) continue;
        const auto twice = std::ranges::find_if(state.actuations, is_pressure);
        if (twice == state.actuations.end()) continue;
        throw InvalidInput(fmt::format(
            "states.csv: the pressure of probe {} at time {} acts in all cavities, and actuations.csv tells that of "
            "'{}' in the same state. Leave it empty in states.csv.",
            state.probe, state.time, set.actuators[static_cast<std::size_t>(twice->actuator)].name));
    }
}

void note_unused(MeasurementSet& set) {
    for (std::size_t a = 0; a < set.actuators.size(); ++a) {
        const auto acts = [&](const LoadState& state) {
            return std::ranges::find(state.actuations, static_cast<int>(a), &Actuation::actuator) !=
                   state.actuations.end();
        };
        if (std::ranges::none_of(set.states, acts))
            set.notes.push_back(fmt::format("Actuator '{}' is at 0 in all states: actuations.csv has no row of it.",
                                            set.actuators[a].name));
    }
}

}  // namespace

void check_actuators(MeasurementSet& set) {
    if (set.actuators.empty()) return;
    carve_chambers(set);
    const RestBody body(set.rest_surface);
    std::map<std::vector<int>, std::string> actuator_of;  // of each cavity, by its triangles
    for (const mesh::Actuator& actuator : set.actuators) {
        if (const auto* tendon = std::get_if<mesh::TendonActuator>(&actuator.kind)) {
            check_tendon(*tendon, body, actuator.name, "set.yaml");
            note_bowstring(*tendon, body, actuator.name, set.notes);
            continue;
        }
        const auto& cavity = std::get<mesh::PressureActuator>(actuator.kind).cavity;
        if (std::holds_alternative<mesh::Surface>(cavity)) continue;
        const mesh::Shell shell = nearest_cavity(set.rest_surface, std::get<Vec3>(cavity),
                                                 fmt::format("set.yaml: actuator '{}'", actuator.name));
        const auto [other, is_new] = actuator_of.try_emplace(shell.triangles, actuator.name);
        if (!is_new)
            throw InvalidInput(
                fmt::format("set.yaml: actuators '{}' and '{}' are near the same cavity, of {:.4g} mm^3. Give each a "
                            "point in its own chamber.",
                            other->second, actuator.name, std::abs(shell.volume)));
    }
    check_known_pressure(set);
    note_unused(set);
}

}  // namespace palpate::identify
