#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

// What a rig's own file holds, whatever wrote it: points that were followed, quantities that were sampled, events.
// Units are ours (mm, N, N*mm, MPa, s, rad); the frame and the clock are the file's.

namespace palpate::identify {

/// A point that was followed by a camera, a tracker or image correlation.
struct RecordedPoint {
    std::string name;     ///< as the file names it; "1", "2", ... where it does not
    Eigen::Matrix3Xd at;  ///< (3 x frames) position [mm] in the recording's frame; NaN where it was not seen
    Eigen::Matrix3Xd
        displacement;  ///< (3 x frames) displacement [mm] as the file tells it; empty where it tells positions only
};

/// A quantity that was sampled: a force, a moment, a pressure, a displacement of a crosshead, a trigger.
struct RecordedChannel {
    std::string name;
    std::string unit;  ///< of values: "N", "N*mm", "MPa", "mm", "s", "rad", or as the file says where the quantity is
                       ///< not known ("V"); "" untold
    Eigen::VectorXd values;  ///< (frames); NaN where the cell is empty
};

/// An event that the file marks.
struct RecordedEvent {
    std::string name;
    double time = 0;  ///< [s]
};

/// What one file of a rig holds on one clock. A C3D file gives two: its points, and its analogs at their own rate.
struct Recording {
    std::string source;      ///< file name, and of which part ("run.c3d, analogs")
    std::string format;      ///< what the file was recognised as, in words
    Eigen::VectorXd times;   ///< (frames) [s], ascending; frame numbers where the file has no clock
    bool has_clock = false;  ///< whether times are seconds
    std::vector<RecordedPoint> points;
    bool in_pixels = false;  ///< positions are in pixels of a size that is not known, each taken as 1 mm
    std::vector<RecordedChannel> channels;
    std::vector<RecordedEvent> events;
    std::vector<std::string> notes;  ///< what was found out by itself: delimiter, decimal comma, unit row, encoding
};

}  // namespace palpate::identify
