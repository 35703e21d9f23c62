#pragma once

#include "identify/recordings/assembly/clocks/signal.h"

namespace palpate::identify {

/// How another clock's times become those of the reference: t_reference = offset + rate t.
struct ClockFit {
    double offset = 0;  // [s]
    double rate = 1;
    double sd = 0;       // of the time that it gives, in the middle of the recording [s]
    double rate_sd = 0;  // 0: the rate was not estimated
};

/// How well two signals agree when one is shifted.
struct LagEstimate {
    ClockFit clock;
    double correlation = 0;           // at the best shift, [0, 1]
    double rival = 0, rival_lag = 0;  // at the best one outside of its peak, and which [s]
    bool is_clear = false;            // whether the peak stands out
};

/// The shift at which a force and a motion agree best.
///
/// First the correlation of both signals' changes, each over the same short time, for all shifts that leave half of the
/// shorter one overlapping: its peak is clear where it is 0.5 at least and no other peak has 0.8 of it. Then, with
/// both smoothed alike, which shifts neither, the force is fitted by a parabola of the motion, as a stiffening body
/// answers: the sum of squares S(lag) has its least within a sample, by Newton's steps;
///   sd^2 = 2 s^2 k / S''(lag),   s^2 = S / (n - 4),   k = (1 + r) / (1 - r)
/// with r the correlation of successive residuals. Where more than one landmark is seen the clocks' rates are fitted
/// along, and kept where they differ by more than 4 sd of the same Hessian.
///
/// @pre both without gaps, at least ten samples each
LagEstimate estimate_lag(const Signal& motion, const Signal& force);

}  // namespace palpate::identify
