#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identify/recordings/assembly/map/plateau_options.h"

namespace palpate::identify {

/// Signals of one kind on one clock: the coordinates of all points, or one channel.
struct SignalGroup {
    Eigen::MatrixXd rows;  // (signals x frames); NaN where there is none
    // How far the group moves altogether, rms over its signals. None: in these frames. A recording that shows little of
    // what its siblings show is given theirs.
    std::optional<double> range = {};
};

/// Frames [first, last) in which nothing moves.
struct Plateau {
    Eigen::Index first = 0, last = 0;
};

/// The plateaus of piecewise constant signals under noise.
///
/// Over each window of the shortest length every signal's slope is fitted by least squares, and the change it makes
/// over the window taken, rms over the group. The window stands still if that is less than `still` of the group's
/// range, or than what noise alone makes of a constant in 997 of 1000 windows, 3 sqrt(12 / n) sigma, sigma by
/// `noise_of`. Frames of a window that stands still belong to a plateau; frames at its ends that lie off its line by
/// more than 4 sd of its middle half are taken off.
std::vector<Plateau> find_plateaus(const Eigen::VectorXd& times, const std::vector<SignalGroup>& groups,
                                   const PlateauOptions& options = {});

/// The mean of samples that stand still.
struct SteadyValue {
    double mean = 0;
    double sigma = 0;  // of the mean
    double drift = 0;  // how much it changed from the first sample to the last, by the line through them
    int samples = 0;
};

/// Mean of the finite ones of samples that follow each other. Its sigma is, in squares, the noise about the line
/// through them over the number of independent samples, n (1 - r) / (1 + r) with r the correlation of successive ones;
/// the error of rounding, which no mean removes; and a twelfth of the drift's square: at one instant the value lay
/// somewhere on it.
SteadyValue steady_value(const Eigen::Ref<const Eigen::VectorXd>& samples);

/// Of a plateau that drifts by more than it scatters: its last quarter, two frames at least, where it has settled most.
Plateau settled_part(const Plateau& plateau, const std::vector<SignalGroup>& groups);

}  // namespace palpate::identify
