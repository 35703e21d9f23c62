#include "identify/motion/ringing_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <unsupported/Eigen/NonLinearOptimization>
#include <vector>

#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

// What is believed before measuring: 95 % of ratios lie in 0.006 to 0.6, densities and rates make frequencies differ by
// a third, and a skeleton's modes are nearly the body's.
constexpr double middle_ratio = 0.06, ratio_sd = 1.2, share_sd = 1.5, speed_sd = 0.35;
constexpr double own_ratio_sd = 0.35, own_speed_sd = 0.05, own_gain_sd = 0.2;

/// Median time between instants [s].
double spacing(const Ringdown& ringdown) {
    std::vector<double> gaps(static_cast<std::size_t>(ringdown.times.size()));
    std::adjacent_difference(ringdown.times.begin(), ringdown.times.end(), gaps.begin());
    if (gaps.size() < 2) return 1e-3;
    return mesh::upper_median(std::vector(gaps.begin() + 1, gaps.end()));  // the first is a time, not a difference
}

/// Errors of a fit and prior as Eigen's Levenberg-Marquardt takes them.
struct LeastSquares {
    using Scalar = double;
    enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
    using InputType = Eigen::VectorXd;
    using ValueType = Eigen::VectorXd;
    using JacobianType = Eigen::MatrixXd;

    std::function<Eigen::VectorXd(const Eigen::VectorXd&)> errors;
    std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> jacobian;
    int count, parameters;

    int inputs() const { return parameters; }
    int values() const { return count; }
    int operator()(const Eigen::VectorXd& v, Eigen::VectorXd& out) const {
        out = errors(v);
        return 0;
    }
    int df(const Eigen::VectorXd& v, Eigen::MatrixXd& out) const {
        out = jacobian(v);
        return 0;
    }
};

}  // namespace

RingdownFit::RingdownFit(const Ringdowns& ringdowns, DampingLaw law) : ringdowns_(ringdowns), law_(law) {
    const int modes = ringdowns.vibration.modes();
    if (law == DampingLaw::both) speed_ = 2;
    delay_ = speed_ + 1;
    const int recordings = static_cast<int>(ringdowns.recordings.size());
    first_own_ = delay_ + recordings;
    prior_.mean = Eigen::VectorXd::Zero(own(modes));
    prior_.sd = prior_.mean;
    prior_.mean[0] = std::log(middle_ratio);
    prior_.sd[0] = ratio_sd;
    if (law == DampingLaw::both) prior_.sd[1] = share_sd;
    prior_.sd[speed_] = speed_sd;
    for (int r = 0; r < recordings; ++r) prior_.sd[delay_ + r] = spacing(ringdowns.recordings[r]);
    for (int mode = 0; mode < modes; ++mode) {
        prior_.sd.segment<3>(own(mode)) << own_ratio_sd, own_speed_sd, own_gain_sd;
    }
}

double RingdownFit::speed(const Eigen::VectorXd& theta) const { return std::exp(theta[speed_]); }
double RingdownFit::common_ratio(const Eigen::VectorXd& theta) const { return std::exp(theta[0]); }
double RingdownFit::share_of_mass(const Eigen::VectorXd& theta) const {
    if (law_ == DampingLaw::both) return 1 / (1 + std::exp(-theta[1]));
    return law_ == DampingLaw::mass ? 1 : 0;
}

Oscillator RingdownFit::oscillator(const Eigen::VectorXd& theta, int mode, bool own_too) const {
    const Eigen::VectorXd& w = ringdowns_.vibration.frequencies;
    const double faster = w[mode] / w[0], mass = share_of_mass(theta);
    Oscillator made{.frequency = w[mode] * speed(theta),
                    .ratio = common_ratio(theta) * (mass / faster + (1 - mass) * faster)};
    if (own_too) {
        made.ratio *= std::exp(theta[own(mode)]);
        made.frequency *= std::exp(theta[own(mode) + 1]);
    }
    return made;
}

Eigen::MatrixXd RingdownFit::played(const Eigen::VectorXd& theta, int r) const {
    const int modes = ringdowns_.vibration.modes();
    std::vector<Oscillator> oscillators(static_cast<std::size_t>(modes));
    Eigen::VectorXd gain(modes);
    for (int mode = 0; mode < modes; ++mode) {
        oscillators[mode] = oscillator(theta, mode, true);
        gain[mode] = std::exp(theta[own(mode) + 2]);
    }
    return ringdowns_.recordings[r].played(ringdowns_.shapes, oscillators, gain, theta[delay_ + r]);
}

Eigen::MatrixXd RingdownFit::errors(const Eigen::VectorXd& theta, int r) const {
    const Ringdown& ringdown = ringdowns_.recordings[r];
    Eigen::MatrixXd difference = (ringdown.weights.array() > 0).select(ringdown.measured - played(theta, r), 0.0);
    for (Eigen::Index row = 0; row < difference.rows(); ++row) {
        const auto weights = ringdown.weights.row(row).array().square();
        if (weights.sum() == 0) continue;
        difference.row(row).array() -= (difference.row(row).array() * weights).sum() / weights.sum();
    }
    return difference.cwiseProduct(ringdown.weights);
}

Eigen::VectorXd RingdownFit::all_errors(const Eigen::VectorXd& theta) const {
    Eigen::Index size = 0, row = 0;
    for (const Ringdown& ringdown : ringdowns_.recordings) size += ringdown.weights.size();
    Eigen::VectorXd all(size);
    for (int r = 0; r < static_cast<int>(ringdowns_.recordings.size()); ++r) {
        const Eigen::MatrixXd one = errors(theta, r);
        all.segment(row, one.size()) = one.reshaped();
        row += one.size();
    }
    return all;
}

double RingdownFit::half_square(const Eigen::VectorXd& theta) const { return all_errors(theta).squaredNorm() / 2; }

Eigen::MatrixXd RingdownFit::jacobian(const Eigen::VectorXd& theta) const {
    constexpr double share = 1e-4;  // of a prior's sd
    const Eigen::VectorXd here = all_errors(theta);
    Eigen::MatrixXd jacobian(here.size(), theta.size());
    for (Eigen::Index p = 0; p < theta.size(); ++p) {
        Eigen::VectorXd there = theta;
        there[p] += share * prior_.sd[p];
        jacobian.col(p) = (all_errors(there) - here) / (share * prior_.sd[p]);
    }
    return jacobian;
}

Eigen::VectorXd RingdownFit::most_probable(const Eigen::VectorXd& start, double variance) const {
    const double scale = 1 / std::sqrt(variance);
    const auto theta_of = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
        return prior_.mean + prior_.sd.cwiseProduct(v);
    };
    const auto P = static_cast<Eigen::Index>(prior_.sd.size());
    const Eigen::Index count = all_errors(start).size();
    LeastSquares problem{.errors =
                             [&](const Eigen::VectorXd& v) {
                                 Eigen::VectorXd out(count + P);
                                 out << scale * all_errors(theta_of(v)), v;
                                 return out;
                             },
                         .jacobian =
                             [&](const Eigen::VectorXd& v) {
                                 Eigen::MatrixXd out(count + P, P);
                                 out << scale * jacobian(theta_of(v)) * prior_.sd.asDiagonal(),
                                     Eigen::MatrixXd::Identity(P, P);
                                 return out;
                             },
                         .count = static_cast<int>(count + P),
                         .parameters = static_cast<int>(P)};
    Eigen::VectorXd v = prior_.whitened(start);
    Eigen::LevenbergMarquardt<LeastSquares> search(problem);
    search.parameters.maxfev = 60;
    search.minimize(v);
    return theta_of(v);
}

Eigen::VectorXd RingdownFit::scanned(double variance) const {
    constexpr double reach = 2;          // sd of the speed
    constexpr double out_of_step = 0.1;  // of a cycle, that neighbours on the grid are so far apart in the end
    constexpr int most = 400;            // steps of the grid, which bound its cost; then it is coarser
    double cycles = 1;
    for (const Ringdown& ringdown : ringdowns_.recordings)
        cycles = std::max(cycles,
                          ringdown.times[ringdown.times.size() - 1] * ringdowns_.vibration.frequencies[0] / (2 * M_PI));
    const int steps = std::min(most, static_cast<int>(std::ceil(2 * reach * speed_sd * cycles / out_of_step)));
    Eigen::VectorXd best = prior_.mean;
    double least = INFINITY;
    for (const double ratio : {0.01, 0.03, 0.1, 0.3}) {
        for (int i = 0; i <= steps; ++i) {
            Eigen::VectorXd theta = prior_.mean;
            theta[0] = std::log(ratio);
            theta[speed_] = reach * speed_sd * (2.0 * i / std::max(1, steps) - 1);
            const double value = half_square(theta) / variance + prior_.half_square(theta);
            if (value < least) {
                least = value;
                best = theta;
            }
        }
    }
    return best;
}

}  // namespace palpate::identify
