#include "identify/recordings/assembly/clocks/triggers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::identify {
namespace {

struct PairedEdges {
    ClockFit clock;
    double rms = 0;  // [s]
};

/// t_reference = offset + rate t through the pairs (reference[from + i], other[i]).
PairedEdges fit_edges(const double* reference, const double* other, Eigen::Index n, double edge_sd) {
    const Eigen::Map<const Eigen::ArrayXd> y(reference, n), x(other, n);
    const double mx = x.mean(), my = y.mean(), spread = (x - mx).square().sum();
    PairedEdges paired;
    if (n > 1 && spread > 0) paired.clock.rate = ((x - mx) * (y - my)).sum() / spread;
    paired.clock.offset = my - paired.clock.rate * mx;
    paired.rms = std::sqrt((y - paired.clock.offset - paired.clock.rate * x).square().mean());
    // errors of edges show in the fit from three on
    const auto count = static_cast<double>(n);
    const double sd = std::max(edge_sd, n > 2 ? paired.rms * std::sqrt(count / (count - 2)) : 0);
    paired.clock.sd = sd / std::sqrt(count);
    if (n > 1 && spread > 0) paired.clock.rate_sd = sd / std::sqrt(spread);
    return paired;
}

}  // namespace

std::vector<double> edges_of(const Signal& raw, bool rising, std::optional<double> level) {
    constexpr double back = 0.1;  // of the range
    const Signal signal = without_gaps(raw);
    std::vector<double> edges;
    if (signal.values.size() < 2) return edges;
    const double least = signal.values.minCoeff(), most = signal.values.maxCoeff();
    const double sign = rising ? 1 : -1, at = level.value_or((least + most) / 2);
    const double armed_below = sign * at - back * (most - least);
    bool is_armed = sign * signal.values[0] <= armed_below;
    for (Eigen::Index i = 1; i < signal.values.size(); ++i) {
        const double before = sign * signal.values[i - 1], here = sign * signal.values[i];
        if (is_armed && here > sign * at) {
            const double share = here > before ? (sign * at - before) / (here - before) : 1;
            edges.push_back(signal.times[i - 1] +
                            std::clamp(share, 0.0, 1.0) * (signal.times[i] - signal.times[i - 1]));
            is_armed = false;
        }
        if (here <= armed_below) is_armed = true;
    }
    return edges;
}

std::optional<ClockFit> match_edges(const std::vector<double>& reference, const std::vector<double>& other,
                                    double interval, double other_interval) {
    if (reference.empty() || other.empty()) return std::nullopt;
    // an edge lies somewhere between two samples: uniformly
    const double edge_sd = std::hypot(interval, other_interval) / std::sqrt(12.0);
    const auto n = static_cast<Eigen::Index>(std::min(reference.size(), other.size()));
    const std::size_t more = std::max(reference.size(), other.size()) - static_cast<std::size_t>(n);
    if (n == 1 && more > 0) return std::nullopt;
    std::optional<PairedEdges> best;
    double second = std::numeric_limits<double>::infinity();
    for (std::size_t shift = 0; shift <= more; ++shift) {
        const bool is_of_reference = reference.size() > other.size();
        const PairedEdges paired = fit_edges(reference.data() + (is_of_reference ? shift : 0),
                                             other.data() + (is_of_reference ? 0 : shift), n, edge_sd);
        const bool is_a_clock = paired.clock.rate > 0.9 && paired.clock.rate < 1.1;  // quartz errs by 1e-4
        if (!is_a_clock) continue;
        if (!best || paired.rms < best->rms) {
            if (best) second = best->rms;
            best = paired;
        } else {
            second = std::min(second, paired.rms);
        }
    }
    // another pairing that leaves no more than edges are known by would do as well
    if (!best || second < std::max(2 * best->rms, 3 * edge_sd)) return std::nullopt;
    return best->clock;
}

}  // namespace palpate::identify
