#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/files/text/number_table.h"
#include "identify/recordings/recording.h"

namespace palpate::identify {

/// Of what was not seen, or is missing.
inline constexpr double not_seen = std::numeric_limits<double>::quiet_NaN();

/// A recording of which only source and format are known.
Recording begun(const std::string& source, const std::string& format);

/// Positions of which a coordinate is missing are missing altogether.
void drop_partly_seen(Eigen::Matrix3Xd& at);

/// Frames at this rate [1/s], the first one at `first` frames.
void set_rate(double rate, Eigen::Index frames, double first, Recording& recording);

/// Frames that have no clock: numbers from 0.
void set_no_clock(Eigen::Index frames, Recording& recording);

/// Times of a column: seconds, another unit, times of day, or counts since 1970. @param where names a row, for messages
/// @throws InvalidInput where one is missing, or they run backwards.
void set_times(const NumberColumn& column, const FileMap& map,
               const std::function<std::string(Eigen::Index row)>& where, Recording& recording);

/// What one unit of the file's positions is [mm]: by the map, or as the file tells it; what is assumed is noted.
/// @throws InvalidInput where it is no length.
double position_factor(const FileMap& map, const std::string& told, const std::string& file, Recording& recording);

/// The map's names for the points, in their order. @throws InvalidInput where they are not as many.
void name_points(const FileMap& map, const std::string& file, Recording& recording);

/// A channel in our units where its unit is known.
RecordedChannel in_our_units(const std::string& name, const std::string& unit, Eigen::VectorXd values);

}  // namespace palpate::identify
