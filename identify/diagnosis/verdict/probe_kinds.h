#pragma once

#include <array>

namespace palpate::identify {

/// Kinds of probes, as an effect's description and a diagnosis name them.
namespace probe_kinds {
inline constexpr const char* load = "load";                // press, or pull, elsewhere
inline constexpr const char* orientation = "orientation";  // read the unloaded body turned with its support
inline constexpr const char* pressure = "pressure";        // read it with its cavities open
inline constexpr const char* dwell = "dwell";              // hold a load, and read it soon and late
inline constexpr const char* load_removed = "unload";      // load further than ever, and read on the way back
inline constexpr const char* repeat = "repeat";            // one probe once more
inline constexpr const char* fiducials = "fiducials";      // read what stands still
inline constexpr std::array all{load, orientation, pressure, dwell, load_removed, repeat, fiducials};
}  // namespace probe_kinds

}  // namespace palpate::identify
