#include "identify/recordings/assembly/states/imported_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/numerics/summaries.h"
#include "mesh/errors.h"
#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

constexpr double little = 0.05;            // of what all probes show: this one shows hardly any motion
constexpr std::size_t most_states = 5000;  // equilibria that an identification may take: a choice of cost

/// All coordinates that were ever seen, a row each.
Eigen::MatrixXd coordinates(const std::vector<RecordedPoint>& points, Eigen::Index frames) {
    std::vector<Eigen::RowVectorXd> rows;
    for (const RecordedPoint& point : points)
        for (int axis = 0; axis < 3; ++axis)
            if (point.at.row(axis).array().isFinite().any()) rows.emplace_back(point.at.row(axis));
    Eigen::MatrixXd all(std::ssize(rows), frames);
    for (std::size_t r = 0; r < rows.size(); ++r) all.row(static_cast<Eigen::Index>(r)) = rows[r];
    return all;
}

/// How far the rows' ends of ten pieces lie apart, rms over rows, at most.
double range_of_rows(const Eigen::MatrixXd& rows) {
    const Eigen::Index pieces = std::min<Eigen::Index>(rows.cols(), 40);
    if (rows.rows() == 0 || pieces < 2) return 0;
    Eigen::MatrixXd means(rows.rows(), pieces);
    for (Eigen::Index p = 0; p < pieces; ++p) {
        const Eigen::Index from = p * rows.cols() / pieces, to = (p + 1) * rows.cols() / pieces;
        for (Eigen::Index r = 0; r < rows.rows(); ++r)
            means(r, p) = steady_value(rows.row(r).segment(from, to - from).transpose()).mean;
    }
    double range = 0;
    for (Eigen::Index a = 0; a < pieces; ++a)
        range = std::max(range, (means.colwise() - means.col(a)).colwise().norm().maxCoeff());
    return range / std::sqrt(static_cast<double>(rows.rows()));
}

/// What has to stand still: the points, and channels that load the body.
std::vector<SignalGroup> groups_of(const ImportMap& map, const ProbeRecording& probe, double range) {
    std::vector<SignalGroup> groups;
    if (!probe.points.empty()) {
        SignalGroup points{coordinates(probe.points, probe.times.size()), {}};
        if (points.rows.rows() > 0) {
            if (range_of_rows(points.rows) < little * range) points.range = range;
            groups.push_back(std::move(points));
        }
    }
    for (const MappedUse& use : map.uses) {
        const NamedSignal* channel = probe.channel(use.channel);
        // a reaction answers what stands still; where points are seen, these tell that
        if (!channel || (use.kind == MappedUse::Kind::reaction && !groups.empty())) continue;
        const Signal signal = without_gaps(channel->signal);
        if (signal.times.size() < 2) continue;
        SignalGroup group{Eigen::MatrixXd(1, probe.times.size()), {}};
        const double apart = interval_of(probe.times);
        const Signal smooth = interval_of(signal.times) < apart ? smoothed(signal, apart) : signal;
        for (Eigen::Index f = 0; f < probe.times.size(); ++f) group.rows(0, f) = value_at(smooth, probe.times[f]);
        groups.push_back(std::move(group));
    }
    return groups;
}

std::vector<Plateau> every_so_often(const Eigen::VectorXd& times, double every) {
    std::vector<Plateau> parts;
    const auto frames = times.size();
    for (Eigen::Index first = 0; first < frames;) {
        const double end = times[first] + every;
        Eigen::Index last = first + 1;
        while (last < frames && times[last] < end) ++last;
        parts.push_back({first, last});
        first = last;
    }
    // A few frames that are left over tell little of their noise: they belong to the part before.
    if (const std::size_t n = parts.size(); n > 1) {
        const Plateau rest = parts.back();
        Plateau& before = parts[n - 2];
        if (2 * (rest.last - rest.first) < before.last - before.first) {
            before.last = rest.last;
            parts.pop_back();
        }
    }
    return parts;
}

SteadyPoint steady_point(const RecordedPoint& point, const Plateau& part, double& drift_squares) {
    SteadyPoint steady;
    double squares = 0;
    int seen = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const SteadyValue value =
            steady_value(point.at.row(axis).segment(part.first, part.last - part.first).transpose());
        if (value.samples == 0) continue;
        steady.at[axis] = value.mean;
        steady.samples = std::max(steady.samples, value.samples);
        squares += value.sigma * value.sigma;
        drift_squares += value.drift * value.drift;
        ++seen;
    }
    if (seen > 0 && squares > 0) steady.sigma = std::sqrt(squares / seen);
    return steady;
}

/// A channel's mean over the state, or what it is at its middle.
SteadyValue channel_value(const Signal& signal, double from, double to) {
    const double* begin = signal.times.data();
    const auto n = signal.times.size();
    const Eigen::Index first = std::lower_bound(begin, begin + n, from) - begin,
                       last = std::upper_bound(begin, begin + n, to) - begin;
    if (last > first) return steady_value(signal.values.segment(first, last - first));
    const double between = value_at(signal, (from + to) / 2);
    return std::isnan(between) ? SteadyValue{} : SteadyValue{between, noise_of(signal.values), 0, 1};
}

SteadyValue value_of(const MappedUse& use, const ProbeRecording& probe, double from, double to) {
    SteadyValue value;
    if (use.channel.empty()) return value;
    if (const NamedSignal* channel = probe.channel(use.channel))
        value = channel_value(without_gaps(channel->signal), from, to);
    const auto told = std::ranges::find(probe.values, use.channel, &MappedValue::name);
    if (value.samples == 0 && told != probe.values.end()) value = {told->value, 0, 0, 1};
    value.mean = use.scale * value.mean + (value.samples > 0 ? use.offset : 0);
    value.sigma *= std::abs(use.scale);
    value.drift *= use.scale;
    return value;
}

/// Distance between two states' points, rms over the coordinates that both show [mm].
double distance(const ImportedState& a, const ImportedState& b) {
    double squares = 0;
    int count = 0;
    for (std::size_t p = 0; p < a.points.size(); ++p)
        for (int axis = 0; axis < 3; ++axis) {
            const double off = a.points[p].at[axis] - b.points[p].at[axis];
            if (!std::isfinite(off)) continue;
            squares += off * off;
            ++count;
        }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

double common_range(const std::vector<ProbeRecording>& probes) {
    double range = 0;
    for (const ProbeRecording& probe : probes) {
        range = std::max(range, range_of_rows(coordinates(probe.points, probe.times.size())));
        for (const ProbeRecording& other : probes) {
            double squares = 0;
            int count = 0;
            for (const RecordedPoint& point : probe.points) {
                const RecordedPoint* same = &other == &probe ? nullptr : other.point(point.name);
                if (!same) continue;
                for (int axis = 0; axis < 3; ++axis) {
                    const SteadyValue a = steady_value(point.at.row(axis).transpose()),
                                      b = steady_value(same->at.row(axis).transpose());
                    if (a.samples == 0 || b.samples == 0) continue;
                    squares += (a.mean - b.mean) * (a.mean - b.mean);
                    ++count;
                }
            }
            if (count > 0) range = std::max(range, std::sqrt(squares / count));
        }
    }
    return range;
}

void moderate_sigmas(std::vector<SteadyPoint>& points) {
    constexpr double shared = 4;  // degrees of freedom: those of a line through six frames
    std::vector<double> variances;
    for (const SteadyPoint& point : points)
        if (point.sigma > 0) variances.push_back(point.sigma * point.sigma);
    if (variances.empty()) return;
    const double typical = mesh::upper_median(std::move(variances));
    for (SteadyPoint& point : points) {
        if (point.samples == 0) continue;
        const double own = known_part(point.sigma * point.sigma), freedom = std::max(0, point.samples - 2);
        point.sigma = std::sqrt(std::max(own, (freedom * own + shared * typical) / (freedom + shared)));
    }
}

std::vector<ImportedState> find_states(const ImportMap& map, const ProbeRecording& probe, double range,
                                       std::vector<std::string>& notes) {
    const Eigen::VectorXd& times = probe.times;
    const std::vector<SignalGroup> groups = groups_of(map, probe, range);
    std::vector<Plateau> parts;
    if (map.states.kind == StateRule::Kind::plateaus && times.size() < 3) {
        parts.push_back({0, times.size()});
    } else if (map.states.kind == StateRule::Kind::plateaus) {
        parts = find_plateaus(times, groups, map.states.plateaus);
        if (parts.empty())
            throw InvalidInput(fmt::format(
                "{}: nothing stands still in probe {}, so it has no plateaus. Take a state every so often (--states "
                "every=0.5s), or say what still is (plateaus: {{shortest: 0.2, within: 0.5}}).",
                fmt::join(probe.files, ", "), probe.probe));
    } else {
        parts = every_so_often(times, map.states.kind == StateRule::Kind::all ? 0 : map.states.every);
    }
    if (parts.size() > most_states)
        throw InvalidInput(
            fmt::format("{}: {} states are more than a set is good for ({}). Take them less often (--states "
                        "every=0.5s).",
                        fmt::join(probe.files, ", "), parts.size(), most_states));

    std::vector<ImportedState> states;
    const double half = interval_of(times) / 2;
    int drifting = 0;
    double largest = 0;
    for (const Plateau& whole : parts) {
        const bool is_plateau = map.states.kind == StateRule::Kind::plateaus;
        const Plateau part = is_plateau ? settled_part(whole, groups) : whole;
        ImportedState state;
        state.probe = probe.probe;
        state.from = times[part.first] - half;
        state.to = times[part.last - 1] + half;
        // shorter than the interval by far: what rounding leaves is no time
        const double per_second = std::pow(10, 1 - std::floor(std::log10(std::max(half, 1e-9))));
        state.time = std::round((times[part.first] + times[part.last - 1]) / 2 * per_second) / per_second;
        double squares = 0;
        for (const RecordedPoint& point : probe.points) state.points.push_back(steady_point(point, part, squares));
        moderate_sigmas(state.points);
        if (!probe.points.empty()) state.drift = std::sqrt(squares / (3.0 * static_cast<double>(probe.points.size())));
        for (const MappedUse& use : map.uses) state.values.push_back(value_of(use, probe, state.from, state.to));
        if (is_plateau && part.first != whole.first) {
            ++drifting;
            largest = std::max(largest, state.drift);
        }
        states.push_back(std::move(state));
    }
    double most = 0;
    for (const ImportedState& state : states) most = std::max(most, distance(state, states.front()));
    for (ImportedState& state : states) {
        const double away = distance(state, states.front());
        state.has_moved = away > most / 2;
        state.is_back = away <= most / 10;
    }
    if (drifting > 0)
        notes.push_back(fmt::format(
            "Probe {}: {} of {} plateaus drift by more than they scatter, as of a body that creeps; each is the mean "
            "of its "
            "last quarter, over which it moves by {:.2g} mm at most (in sigma). '--states every=1s' keeps the course.",
            probe.probe, drifting, parts.size(), largest));
    return states;
}

}  // namespace palpate::identify
