#pragma once

#include <string>
#include <vector>

#include "identify/recordings/recording.h"

namespace palpate::identify {

struct TrackRepair {
    int swaps = 0;       // instants at which tracks had exchanged their points, and were exchanged back
    int flickers = 0;    // readings off for a few frames, taken out
    int vanishings = 0;  // gaps after which a track went on
};

/// Finds where a tracking system lost its markers, and mends it.
///
/// A point that goes further from one frame to the next than a quarter of the way to its nearest neighbour is
/// suspected. The points of that frame are then given to the tracks anew, all together with the least sum of squared
/// ways [Kuhn 1955, Munkres 1957]; where that exchanges tracks and takes half the squares at most, the tracks are cut
/// there and go on exchanged. What comes back to where it was within five frames flickered; the frames between are
/// taken out. More than a hundred points are image correlation's, which follows each by its own speckle: these are left
/// alone.
TrackRepair mend_tracks(std::vector<RecordedPoint>& points);

/// What was done, in words; "" where nothing was.
std::string describe(const TrackRepair& repair);

}  // namespace palpate::identify
