#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/recordings/assembly/map/plateau_options.h"
#include "identify/recordings/files/file_map.h"

namespace palpate::identify {

/// A number that no file holds, as of a weight or of a regulator that was set.
struct MappedValue {
    std::string name;
    double value = 0;  // in our units
    std::string unit;  // of ours that it was told in one of; "" none
};

/// A file of the rig, and what the map says of it.
struct MappedFile {
    std::string file;   // its name, or a pattern of a series
    std::string where;  // "map.yaml, line 4", for messages
    FileMap how;
    int probe = 1;  // files of one probe show the same body at the same time
    std::vector<MappedValue> values;
    bool values_act_always = false;  // otherwise in those states in which the points have left their first place
    bool is_unordered = false;       // which point is which has to be found
};

/// Does an entry, which may be a pattern, name a file? @param name without its folder
bool names_file(const MappedFile& entry, const std::string& name);

/// A point whose place on the mesh is known, or that is a marker of the set.
struct MappedPlace {
    std::string name;              // of the recorded point
    std::optional<Vec3> at;        // in the mesh's frame [mm]
    std::optional<Vec3> attached;  // the surface point that it is fixed to [mm]
    bool is_marker = true;         // else a fiducial: of the clamp, not of the body
};

/// A coordinate that points tell, as if it were a channel.
struct MappedQuantity {
    std::string name;
    std::vector<std::string> points, minus;  // their mean, less that of those
    Vec3 along = Vec3::UnitX();              // unit, in the recording's frame
};

/// What a channel is.
struct MappedUse {
    enum class Kind { force, motion, reaction, actuation };
    Kind kind = Kind::force;
    std::string where;                     // for messages
    int target = -1;                       // index of the tool or actuator; -1: a force
    std::string channel;                   // or a value's, or a quantity's name; "": motion of points
    std::vector<std::string> points = {};  // of a tool: its motion is theirs
    bool turns = false;                    // and its turn
    Vec3 axis = Vec3::UnitX();             // unit, in the mesh's frame
    bool is_about = false;                 // a moment or a turn about the axis
    double scale = 1, offset = 0;          // value = scale channel + offset
    bool tare = false;                     // less what it is in the first state
    double sigma = missing;                // 1 sigma of the value
    Vec3 at = Vec3::Zero();                // of a force [mm]
    double radius = 0;                     // of its patch [mm]
    std::vector<int> free = {};            // coordinates of a motion that are left free
};

/// How the clocks of a probe's files are put on each other.
struct ClockRule {
    enum class Kind { lag, trigger, common };
    Kind kind = Kind::lag;
    std::string channel;          // of the trigger (or event), or the common one
    bool rising = true;           // edge of the trigger
    std::optional<double> level;  // of it
    std::optional<double> lag;    // known: the other files' clocks are so much behind [s]
    std::string motion, force;    // channels that the lag is sought between; "": the points, and what is used
};

struct StateRule {
    enum class Kind { plateaus, every, all };
    Kind kind = Kind::plateaus;
    double every = 0;  // [s]
    PlateauOptions plateaus;
};

/// "plateaus", "every=0.1s" or "all". @param where for the message. @throws InvalidInput.
void parse_states(const std::string& text, const std::string& where, StateRule& rule);

struct RegisterRule {
    enum class Kind { automatic, fiducials, surface, none };
    Kind kind = Kind::automatic;
    bool scale = false;        // fit it too
    double stand_off = 0;      // of points over the surface [mm]
    bool each = false;         // state by state: the rig moved in the camera's frame
    std::optional<Mat3> axes;  // turns the recording's frame to that of the mesh
};

struct ImportMap;

/// "auto", "icp", "none", or a file of name,x,y,z, whose rows become fiducials.
/// @param folders where the file may lie
void parse_register(const std::string& text, const std::string& where,
                    const std::vector<std::filesystem::path>& folders, ImportMap& map);

/// What map.yaml tells: of the files, and of the set that is to be made of them.
struct ImportMap {
    std::filesystem::path file;
    MeasurementSet set;  // all but markers and states
    std::vector<MappedFile> files;
    std::vector<MappedPlace> places;
    std::vector<MappedQuantity> quantities;
    std::vector<MappedUse> uses;
    bool names_markers = false;     // `markers` stands there: other points are none
    std::optional<int> rest_probe;  // whose first state shows the body at rest; absent: the first one's
    bool is_rest_seen = true;
    /// Points rest where the files' displacements count from; absent: where the first frames show them elsewhere.
    std::optional<bool> is_rest_of_files;
    bool reads_displacements = false;  // readings count from the rest's first state
    ClockRule clock;
    StateRule states;
    RegisterRule registration;
};

struct ReadMapOptions {
    std::filesystem::path mesh = {};                  // in place of the map's; empty: the map's
    std::vector<std::filesystem::path> folders = {};  // where files may lie that the map names, beside its own
};

/// Its `files` alone: a map that is not complete has them, too. @throws IoError, InvalidInput as below.
std::vector<MappedFile> read_mapped_files(const std::filesystem::path& map);

/// @throws IoError, InvalidInput naming file, line, value, what is allowed and what to do.
ImportMap read_import_map(const std::filesystem::path& file, const ReadMapOptions& options = {});

}  // namespace palpate::identify
