#include "identify/recordings/assembly/clocks/lag.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::identify {
namespace {

constexpr int most_samples = 2000;     // of a coarse grid: its square is counted out
constexpr double change_width = 4;     // samples of the coarse grid over which a change is taken
constexpr double least_clear = 0.5;    // correlation
constexpr double rival_share = 0.8;    // of the peak
constexpr double lobe_share = 0.5;     // of the peak: where its neighbourhood ends
constexpr double least_overlap = 0.5;  // of the shorter signal

/// Changes of a signal over `width`, on a grid of its own times.
Eigen::VectorXd changes_on_grid(const Signal& signal, double step) {
    const Signal smooth = smoothed(signal, step);
    const double begin = signal.times[0], end = signal.times[signal.times.size() - 1];
    const auto n = static_cast<Eigen::Index>(std::floor((end - begin) / step)) + 1;
    Eigen::VectorXd changes(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double t = begin + static_cast<double>(i) * step, half = change_width / 2 * step;
        changes[i] = value_at(smooth, std::min(t + half, end)) - value_at(smooth, std::max(t - half, begin));
    }
    return changes;
}

/// Correlation of what overlaps when y's sample j lies on x's sample j + shift; 0 where too little does.
Eigen::VectorXd correlations(const Eigen::VectorXd& x, const Eigen::VectorXd& y, Eigen::Index first,
                             Eigen::Index count) {
    const auto least = static_cast<Eigen::Index>(least_overlap * static_cast<double>(std::min(x.size(), y.size())));
    Eigen::VectorXd result = Eigen::VectorXd::Zero(count);
    for (Eigen::Index s = 0; s < count; ++s) {
        const Eigen::Index shift = first + s;
        const Eigen::Index from = std::max<Eigen::Index>(0, -shift), to = std::min(y.size(), x.size() - shift);
        const Eigen::Index n = to - from;
        if (n < std::max<Eigen::Index>(least, 5)) continue;
        const auto a = x.segment(from + shift, n).array(), b = y.segment(from, n).array();
        const double sa = a.square().sum(), sb = b.square().sum();
        if (sa > 0 && sb > 0) result[s] = std::abs((a * b).sum()) / std::sqrt(sa * sb);
    }
    return result;
}

/// Sum of squares that a parabola of the shifted motion leaves of the force.
struct ParabolaFit {
    double squares = 0, neighbours = 0;  // neighbours: the residuals' correlation
    Eigen::Index samples = 0;
};

ParabolaFit fit_parabola(const Signal& motion, const Signal& force, double lag, double fast = 0, double pivot = 0) {
    std::vector<double> x, y;
    for (Eigen::Index i = 0; i < force.times.size(); ++i) {
        const double t = force.times[i], value = value_at(motion, t + lag + fast * (t - pivot));
        if (std::isnan(value)) continue;
        x.push_back(value);
        y.push_back(force.values[i]);
    }
    const auto n = std::ssize(x);
    if (n < 6) return {};
    const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n);
    const Eigen::Map<const Eigen::VectorXd> ys(y.data(), n);
    const double middle = xs.mean(), spread = std::sqrt((xs - middle).square().mean());
    Eigen::MatrixXd A(n, 3);
    A.col(0).setOnes();
    A.col(1) = spread > 0 ? Eigen::VectorXd((xs - middle) / spread) : Eigen::VectorXd::Zero(n);
    A.col(2) = A.col(1).array().square();
    const Eigen::VectorXd left = ys - A * A.colPivHouseholderQr().solve(ys);
    const double squares = left.squaredNorm();
    return {squares, squares > 0 ? left.head(n - 1).dot(left.tail(n - 1)) / squares : 0, n};
}

struct FineLag {
    double lag = 0, sd = 0;
};

/// Newton's steps on the mean square, by differences over a fraction of the sampling. @param within how far from the
/// beginning the lag may be [s]
FineLag refine_lag(const Signal& motion, const Signal& force, double lag, double step, double within) {
    constexpr int most_steps = 30;  // a bound: the lag is within a few samples when this begins
    const double first = lag;
    const auto mean_square = [&](double at) {
        const ParabolaFit fit = fit_parabola(motion, force, at);
        return fit.samples > 0 ? fit.squares / static_cast<double>(fit.samples) : 0;
    };
    // the grid's best neighbour first: Newton's steps want to begin in the basin
    for (const double fine : {0.5, 0.25, 0.125})
        for (int turns = 0; turns < most_steps; ++turns) {
            const double here = mean_square(lag), left = mean_square(lag - fine * step),
                         right = mean_square(lag + fine * step);
            if (here <= left && here <= right) break;
            lag += (left < right ? -fine : fine) * step;
            if (std::abs(lag - first) > within) return {first, within};
        }
    const double h = 0.25 * step;
    double curvature = 0;
    for (int turns = 0; turns < 5; ++turns) {
        const double here = mean_square(lag), left = mean_square(lag - h), right = mean_square(lag + h);
        curvature = (left - 2 * here + right) / (h * h);
        if (!(curvature > 0)) return {lag, within};
        lag += std::clamp((left - right) / (2 * h * curvature), -h, h);
    }
    const ParabolaFit fit = fit_parabola(motion, force, lag);
    const auto n = static_cast<double>(fit.samples);
    const double r = std::clamp(fit.neighbours, 0.0, 0.99);
    const double variance = fit.squares / std::max(1.0, n - 4) * (1 + r) / (1 - r);
    return {lag, std::sqrt(2 * variance / (n * curvature))};
}

/// Lag and rate together, by Newton's steps from the lag alone; the rate is kept where it is beyond 4 sd.
void add_rate(const Signal& motion, const Signal& force, double step, LagEstimate& estimate) {
    const double begin = force.times[0], end = force.times[force.times.size() - 1], middle = (begin + end) / 2;
    const Eigen::Vector2d h(0.25 * step, 0.25 * step / ((end - begin) / 2));  // the ends move by as much as the middle
    const auto mean_square = [&](const Eigen::Vector2d& x) {
        const ParabolaFit fit = fit_parabola(motion, force, x[0], x[1], middle);
        return fit.samples > 0 ? fit.squares / static_cast<double>(fit.samples) : 0;
    };
    Eigen::Vector2d x(estimate.clock.offset, 0);
    Eigen::Matrix2d H;
    for (int turns = 0; turns < 12; ++turns) {
        const Eigen::Vector2d a(h[0], 0), b(0, h[1]);
        const double here = mean_square(x), a1 = mean_square(x + a), a0 = mean_square(x - a), b1 = mean_square(x + b),
                     b0 = mean_square(x - b);
        const double across =
            mean_square(x + a + b) - mean_square(x + a - b) - mean_square(x - a + b) + mean_square(x - a - b);
        H << (a1 - 2 * here + a0) / (h[0] * h[0]), across / (4 * h[0] * h[1]), across / (4 * h[0] * h[1]),
            (b1 - 2 * here + b0) / (h[1] * h[1]);
        if (!(H(0, 0) > 0 && H.determinant() > 0)) return;  // one landmark alone tells no rate
        const Eigen::Vector2d slope((a1 - a0) / (2 * h[0]), (b1 - b0) / (2 * h[1]));
        const Eigen::Vector2d move = -H.inverse() * slope;
        x += move * std::min(1.0, 4 / move.cwiseQuotient(h).cwiseAbs().maxCoeff());
    }
    const ParabolaFit fit = fit_parabola(motion, force, x[0], x[1], middle);
    const auto n = static_cast<double>(fit.samples);
    const double r = std::clamp(fit.neighbours, 0.0, 0.99);
    const Eigen::Matrix2d covariance = 2 * fit.squares / std::max(1.0, n - 5) * (1 + r) / (1 - r) / n * H.inverse();
    const double rate_sd = std::sqrt(covariance(1, 1));
    if (std::abs(x[1]) <= 4 * rate_sd) return;
    estimate.clock = {
        .offset = x[0] - x[1] * middle, .rate = 1 + x[1], .sd = std::sqrt(covariance(0, 0)), .rate_sd = rate_sd};
}

}  // namespace

LagEstimate estimate_lag(const Signal& motion, const Signal& force) {
    const double longest = std::max(motion.times[motion.times.size() - 1] - motion.times[0],
                                    force.times[force.times.size() - 1] - force.times[0]);
    const double step = std::max({interval_of(motion.times), interval_of(force.times), longest / most_samples});
    LagEstimate estimate;
    if (!(step > 0)) return estimate;
    const Eigen::VectorXd x = changes_on_grid(motion, step), y = changes_on_grid(force, step);
    const Eigen::Index first = -y.size() + 1;
    const Eigen::VectorXd c = correlations(x, y, first, x.size() + y.size() - 1);
    Eigen::Index best = 0;
    estimate.correlation = c.maxCoeff(&best);
    const auto lag_of = [&](Eigen::Index s) {
        return motion.times[0] - force.times[0] + static_cast<double>(first + s) * step;
    };

    // the peak's own neighbourhood ends where it has fallen by half, and a change's width beyond
    const auto falls_off = [&](Eigen::Index at) { return c[at] < lobe_share * estimate.correlation; };
    Eigen::Index left = best, right = best;
    const auto width = static_cast<Eigen::Index>(change_width);
    while (left > 0 && !falls_off(left)) --left;
    while (right + 1 < c.size() && !falls_off(right)) ++right;
    for (Eigen::Index s = 0; s < c.size(); ++s) {
        if ((s >= left - width && s <= right + width) || c[s] <= estimate.rival) continue;
        estimate.rival = c[s];
        estimate.rival_lag = lag_of(s);
    }
    estimate.is_clear = estimate.correlation >= least_clear && estimate.rival < rival_share * estimate.correlation;

    const Signal slow = smoothed(motion, 2 * step), answer = smoothed(force, 2 * step);
    const FineLag fine = refine_lag(slow, answer, lag_of(best), step, 20 * step);
    estimate.clock.offset = fine.lag;
    estimate.clock.sd = fine.sd;
    if (estimate.is_clear) add_rate(slow, answer, step, estimate);
    return estimate;
}

}  // namespace palpate::identify
