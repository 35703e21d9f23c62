#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mesh/core/actuator.h"
#include "mesh/core/contact.h"
#include "mesh/core/material_region.h"
#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/tool.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::identify {

inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// Below what any instrument tells: atomic force microscopes end at 1e-8 mm and 1e-12 N.
inline constexpr double least_position_noise = 1e-9;  // [mm]
inline constexpr double least_force_noise = 1e-13;    // [N]
inline constexpr double least_moment_noise = 1e-13;   // [N mm]

struct Marker {
    int id = 0;                  // as in the files; where these name markers by words, the number of its row
    Vec3 rest = Vec3::Zero();    // [mm]
    std::optional<Vec3> anchor;  // the surface point that it is rigidly attached to, when it stands off
    std::string name = {};       // the word that the files name it by; "": its number
};

/// A marker as the files name it.
std::string label_of(const Marker& marker);

/// What tells a state from the others of a set, in every table.
struct StateName {
    int probe = 0;
    double time = 0;  // [s]
    auto operator<=>(const StateName&) const = default;
};

/// A measured position. A missing coordinate is NaN.
struct Reading {
    int marker = -1;               // index in MeasurementSet::markers; -1: unlabelled
    Vec3 position = Vec3::Zero();  // [mm]
    double sigma = missing;        // 1 sigma [mm]; NaN: the set's
    // None: a position. Else how far the marker has moved since that state was measured, added to where it rests: the
    // difference of two positions.
    std::optional<StateName> since = {};
};

/// The measured force of a tool on the body, its moment about the tool's moved origin. What no sensor reads is NaN.
struct ReactionReading {
    int tool = 0;                           // index in MeasurementSet::tools
    Vec3 force = Vec3::Constant(missing);   // [N]
    Vec3 moment = Vec3::Constant(missing);  // [N mm]
    double sigma = missing;                 // 1 sigma of each component of the force [N]; NaN: the set's
};

/// What an actuator was set to: pressure over that outside [MPa], tension [N] or length drawn in [mm].
struct Actuation {
    int actuator = 0;  // index in MeasurementSet::actuators
    double value = 0;
    double sigma = missing;  // 1 sigma; NaN: it is taken to be exact
};

/// An equilibrium: what acted, and what was read.
struct LoadState {
    int probe = 0;
    double time = 0;                              // [s]
    std::vector<mesh::Contact> contacts = {};     // forces [N]; none: unloaded
    std::vector<mesh::ToolMotion> motions = {};   // of the tools that touch the body; a tool without one is away
    std::vector<Actuation> actuations = {};       // of the actuators that act
    std::vector<Reading> readings = {};           // of markers
    std::vector<ReactionReading> reactions = {};  // of tools
    Vec3 gravity = Vec3::Constant(missing);       // known to act [mm/s^2]; NaN: unknown
    double pressure = missing;                    // known to act [MPa]; NaN: unknown
    std::filesystem::path field = {};             // the full displacement field (.vtu), or empty
    double field_unit = 1;                        // length unit of that file [mm]
};

/// Is it a reading of a known marker, with at least one coordinate?
inline bool is_usable(const Reading& reading) { return reading.marker >= 0 && !reading.position.array().isNaN().all(); }

/// Does a force act on one of the state's contacts?
inline bool has_contact_force(const LoadState& state) {
    return std::ranges::any_of(state.contacts, [](const mesh::Contact& c) { return !c.force.isZero(0); });
}

/// How a body moved: what acted on it, and what was read meanwhile.
struct MotionRecording {
    int probe = 0;
    // Each acts from the one before it up to its own time, the last one to the end. One of time 0 acted before the
    // beginning: the body starts from its equilibrium. Without readings.
    std::vector<LoadState> loads;
    struct Instant {
        double time = 0;  // [s]
        std::vector<Reading> readings;
    };
    std::vector<Instant> instants;  // in order of time
};

struct MaterialGuess {
    double young = missing;  // [MPa]
    double poisson = missing;
};

/// Measurements of a body under forces, tools and actuators, in mm, N, s, tonne, rad. Files: the formats
/// palpate-measurements/1 (forces, positions) and /2 (all).
struct MeasurementSet {
    std::string name;
    std::filesystem::path folder;
    mesh::Surface rest_surface;
    std::optional<mesh::VolumeMesh> rest_volume;  // tetrahedra behind it, where the file of the body holds them
    std::vector<mesh::Region> supports;
    std::optional<double> density;         // [tonne/mm^3]
    bool continuous = false;               // history: one body through all states, in order
    std::optional<Vec3> gravity;           // known to act on every state [mm/s^2]
    std::optional<double> position_noise;  // 1 sigma [mm]
    std::optional<double> force_noise;     // 1 sigma [N]
    std::optional<double> reaction_noise;  // 1 sigma of a component of a measured force [N]
    std::optional<double> moment_noise;    // and of a moment [N mm]
    // Over which readings of neighbours in one state err alike [mm]; none: each errs by itself.
    std::optional<double> position_correlation;
    std::optional<MaterialGuess> material;
    std::vector<mesh::Tool> tools;
    std::vector<mesh::Actuator> actuators;
    std::vector<mesh::MaterialRegion> regions;  // of materials of their own
    std::vector<Marker> markers;
    std::vector<LoadState> states;            // in the order of probes.csv
    std::vector<MotionRecording> recordings;  // of bodies in motion; mostly none
    std::vector<std::string> notes;           // what the files leave open and how it was taken, in words
};

/// Does a set say what the format palpate-measurements/1 cannot?
bool needs_second_format(const MeasurementSet& set);

/// The state of that name, or null.
const LoadState* find_state(const MeasurementSet& set, const StateName& name);

/// `path`: the folder or its set.yaml. Units are converted here, once: units.length is the unit of every length of
/// the set (surface, supports, tables, noise), per s^2 that of gravity; Young's modulus is in MPa always.
/// @throws IoError, InvalidInput naming file, line, value, what is allowed and what to do.
MeasurementSet read_measurement_set(const std::filesystem::path& path);

/// A table of contacts alone (probes.csv, in mm, N, s) as states without readings. @throws IoError, InvalidInput.
std::vector<LoadState> read_probes(const std::filesystem::path& file);

/// Writes the set (in mm, N, s) as a folder that `read_measurement_set` reads back equal: whole or not at all. A folder
/// that stands there already is replaced.
///
/// Fields are the caller's: `extra` is given the new folder before it gets its name, and may write more files into
/// it, each field at `field_file(state)`.
/// @throws IoError when it cannot be written; nothing is left behind, and an old folder stays as it was.
void write_measurement_set(const std::filesystem::path& folder, const MeasurementSet& set,
                           const std::function<void(const std::filesystem::path& folder)>& extra = {});

/// Where the full field of a state lies in the set's folder: "field/3_0.5.vtu".
std::filesystem::path field_file(const LoadState& state);

}  // namespace palpate::identify
