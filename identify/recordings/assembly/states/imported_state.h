#pragma once

#include <vector>

#include "identify/recordings/assembly/clocks/probe_recording.h"
#include "identify/recordings/assembly/states/plateaus.h"

namespace palpate::identify {

/// The mean of a point over a state, in the recording's frame.
struct SteadyPoint {
    Vec3 at = Vec3::Constant(missing);  // [mm]; NaN where it was not seen
    double sigma = missing;             // of a coordinate, rms [mm]
    int samples = 0;                    // frames that it was seen in
};

/// Raises sigmas that are small by chance, as over few frames, or nothing, where a track froze: the variance of each
/// point's mean is averaged with the median one of all points, which counts as four degrees of freedom. [moderated
/// variance: Smyth 2004]
void moderate_sigmas(std::vector<SteadyPoint>& points);

/// What one state of a probe shows, before it has the mesh's frame.
struct ImportedState {
    int probe = 0;
    double time = 0;                  // its middle [s], from the probe's first frame
    double from = 0, to = 0;          // [s]
    std::vector<SteadyPoint> points;  // of the probe's points
    std::vector<SteadyValue> values;  // of the map's uses: samples 0 where none was told
    bool has_moved = false;           // its points are further than halfway from where they were at first
    bool is_back = true;              // they are where they were at first, within a tenth of the way
    double drift = 0;                 // of the points from its beginning to its end, rms [mm]
};

/// The states of a probe by the map's rule, at least one. What still drifts is told in `notes`.
/// @param range how far points go in all probes, rms [mm]: what moves by less than 5 % of it stays one state
/// @throws InvalidInput where there is none.
std::vector<ImportedState> find_states(const ImportMap& map, const ProbeRecording& probe, double range,
                                       std::vector<std::string>& notes);

/// How far points go, rms [mm]: within each probe, and between the means of points of one name in several.
double common_range(const std::vector<ProbeRecording>& probes);

}  // namespace palpate::identify
