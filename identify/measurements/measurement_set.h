#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mesh/core/contact.h"
#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::identify {

inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// Below what any instrument tells: atomic force microscopes end at 1e-8 mm and 1e-12 N.
inline constexpr double least_position_noise = 1e-9;  // [mm]
inline constexpr double least_force_noise = 1e-13;    // [N]

struct Marker {
    int id = 0;                  // as in the files
    Vec3 rest = Vec3::Zero();    // [mm]
    std::optional<Vec3> anchor;  // the surface point that it is rigidly attached to, when it stands off
};

/// A measured position. A missing coordinate is NaN.
struct Reading {
    int marker = -1;               // index in MeasurementSet::markers; -1: unlabelled
    Vec3 position = Vec3::Zero();  // [mm]
    double sigma = missing;        // 1 sigma [mm]; NaN: the set's
};

/// An equilibrium: what acted, and what was read.
struct LoadState {
    int probe = 0;
    double time = 0;                           // [s]
    std::vector<mesh::Contact> contacts = {};  // forces [N]; none: unloaded
    std::vector<Reading> readings = {};
    Vec3 gravity = Vec3::Constant(missing);  // known to act [mm/s^2]; NaN: unknown
    double pressure = missing;               // known to act [MPa]; NaN: unknown
    std::filesystem::path field = {};        // the full displacement field (.vtu), or empty
    double field_unit = 1;                   // length unit of that file [mm]
};

/// How a body moved: what acted on it, and what was read meanwhile.
struct Recording {
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

/// Measurements of a body under probing forces, in mm, N, s, tonne. Files: the format palpate-measurements/1.
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
    std::optional<MaterialGuess> material;
    std::vector<Marker> markers;
    std::vector<LoadState> states;      // in the order of probes.csv
    std::vector<Recording> recordings;  // of bodies in motion; mostly none
};

/// `path`: the folder or its set.yaml. Units are converted here, once: units.length is the unit of every length of
/// the set (surface, supports, tables, noise), per s^2 that of gravity; pressure and Young's modulus are in MPa always.
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
