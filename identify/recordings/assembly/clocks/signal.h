#pragma once

#include <Eigen/Core>

namespace palpate::identify {

/// A quantity that was sampled on some clock.
struct Signal {
    Eigen::VectorXd times;   // ascending [s]
    Eigen::VectorXd values;  // NaN where there is none
};

/// Those samples that have a value.
Signal without_gaps(const Signal& signal);

/// Between the samples along straight lines; NaN before the first and after the last. @pre without gaps.
double value_at(const Signal& signal, double time);

/// 1 sigma of what differs from sample to sample: the median of successive differences, which a motion of the signal
/// hardly alters, over its expectation for white noise, 0.6745 sqrt(2). Where most samples equal their neighbours, the
/// error of rounding, the smallest step over sqrt(12). Gaps are skipped.
double noise_of(const Eigen::VectorXd& values);

/// The median time between samples [s]; 0 for less than two.
double interval_of(const Eigen::VectorXd& times);

/// Mean of the samples within half of `width` [s] on both sides, at each sample's time. @pre without gaps.
Signal smoothed(const Signal& signal, double width);

/// The nearest signal that never falls, or never rises, whichever is nearer, in least squares: pool adjacent violators
/// [Ayer et al. 1955]. @pre without gaps.
Signal monotone(const Signal& signal);

}  // namespace palpate::identify
