#include "identify/recordings/assembly/states/plateaus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/recordings/assembly/clocks/signal.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double sure = 3;      // sd of noise that a window may show
constexpr double off_line = 4;  // sd of the plateau's middle, beyond which a frame at its end belongs to a motion

/// A line through the finite ones of some samples.
struct Line {
    double middle = 0, slope = 0, mean = 0, sd = 0;  // value = mean + slope (i - middle); sd about it
    int samples = 0;
    double at(double i) const { return mean + slope * (i - middle); }
};

Line line_through(const Eigen::Ref<const Eigen::VectorXd>& samples) {
    Line line;
    double si = 0, sv = 0;
    for (Eigen::Index i = 0; i < samples.size(); ++i) {
        if (!std::isfinite(samples[i])) continue;
        si += static_cast<double>(i);
        sv += samples[i];
        ++line.samples;
    }
    if (line.samples == 0) return line;
    const double n = line.samples;
    line.middle = si / n;
    line.mean = sv / n;
    double sii = 0, siv = 0, svv = 0;
    for (Eigen::Index i = 0; i < samples.size(); ++i) {
        if (!std::isfinite(samples[i])) continue;
        const double di = static_cast<double>(i) - line.middle, dv = samples[i] - line.mean;
        sii += di * di;
        siv += di * dv;
        svv += dv * dv;
    }
    if (sii > 0) line.slope = siv / sii;
    if (n > 2) line.sd = std::sqrt(std::max(0.0, svv - line.slope * siv) / (n - 2));
    return line;
}

/// Sums over the finite samples before each frame, for lines through windows.
struct RunningSums {
    Eigen::VectorXd n, i, ii, v, iv;

    explicit RunningSums(const Eigen::Ref<const Eigen::RowVectorXd>& row) {
        const auto frames = row.size();
        for (Eigen::VectorXd* sum : {&n, &i, &ii, &v, &iv}) *sum = Eigen::VectorXd::Zero(frames + 1);
        const double finite_mean = mean_of(row);
        for (Eigen::Index f = 0; f < frames; ++f) {
            const bool is_there = std::isfinite(row[f]);
            // about the mean and the middle: sums of squares keep their digits
            const double x = static_cast<double>(f) - static_cast<double>(frames) / 2,
                         y = is_there ? row[f] - finite_mean : 0, w = is_there ? 1 : 0;
            n[f + 1] = n[f] + w;
            i[f + 1] = i[f] + w * x;
            ii[f + 1] = ii[f] + w * x * x;
            v[f + 1] = v[f] + y;
            iv[f + 1] = iv[f] + x * y;
        }
    }

    /// Change over a window of `length` frames from `first` by the line through it; NaN where half is missing.
    double change(Eigen::Index first, Eigen::Index length) const {
        const auto over = [&](const Eigen::VectorXd& sum) { return sum[first + length] - sum[first]; };
        const double count = over(n);
        if (count < std::max(2.0, 0.5 * static_cast<double>(length))) return std::nan("");
        const double spread = over(ii) - over(i) * over(i) / count;
        return (over(iv) - over(i) * over(v) / count) / spread * static_cast<double>(length - 1);
    }

    static double mean_of(const Eigen::Ref<const Eigen::RowVectorXd>& row) {
        double sum = 0, count = 0;
        for (const double value : row)
            if (std::isfinite(value)) sum += value, ++count;
        return count > 0 ? sum / count : 0;
    }
};

/// How far a group goes from where it begins, rms over its signals, at most; smoothed over a window against noise.
double range_of(const Eigen::MatrixXd& rows, Eigen::Index window) {
    const auto frames = rows.cols(), pieces = std::max<Eigen::Index>(1, frames / window);
    Eigen::MatrixXd means(rows.rows(), pieces);
    for (Eigen::Index r = 0; r < rows.rows(); ++r)
        for (Eigen::Index p = 0; p < pieces; ++p)
            means(r, p) =
                line_through(rows.row(r).segment(p * window, std::min(window, frames - p * window)).transpose()).mean;
    double range = 0;
    for (Eigen::Index a = 0; a < pieces; ++a)
        range = std::max(range, (means.colwise() - means.col(a)).colwise().norm().maxCoeff());
    return range / std::sqrt(static_cast<double>(rows.rows()));
}

/// Whether the group stands still in each window.
std::vector<char> still_windows(const SignalGroup& group, Eigen::Index window, double allowed_share,
                                std::optional<double> within) {
    const auto frames = group.rows.cols(), windows = frames - window + 1;
    const double range = group.range.value_or(range_of(group.rows, window));
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(windows), counts = Eigen::VectorXd::Zero(windows);
    double noise = 0;
    for (Eigen::Index r = 0; r < group.rows.rows(); ++r) {
        const RunningSums sums(group.rows.row(r));
        const double sigma = noise_of(group.rows.row(r).transpose());
        noise += sigma * sigma;
        for (Eigen::Index w = 0; w < windows; ++w) {
            const double change = sums.change(w, window);
            if (!std::isfinite(change)) continue;
            squares[w] += change * change;
            ++counts[w];
        }
    }
    // var(slope) = 12 sigma^2 / n^3 a frame, so the change over n frames has sd sigma sqrt(12 / n)
    const double by_noise =
        std::sqrt(12.0 / static_cast<double>(window) * noise / static_cast<double>(group.rows.rows()));
    const double allowed = std::max(within.value_or(allowed_share * range), sure * by_noise);
    std::vector<char> still(static_cast<std::size_t>(windows), 0);
    for (Eigen::Index w = 0; w < windows; ++w)
        still[w] = counts[w] > 0 && std::sqrt(squares[w] / counts[w]) <= allowed ? 1 : 0;
    return still;
}

/// Takes frames off its ends that lie off the line through its middle half.
Plateau trimmed(Plateau plateau, const std::vector<SignalGroup>& groups, double still, std::optional<double> within) {
    const Eigen::Index length = plateau.last - plateau.first, quarter = length / 4;
    if (quarter < 3) return plateau;
    const Eigen::Index from = plateau.first + quarter, middle = length - 2 * quarter;
    Eigen::VectorXd off = Eigen::VectorXd::Zero(length);
    for (const SignalGroup& group : groups) {
        const double range =
            within.value_or(still * group.range.value_or(range_of(group.rows, std::max<Eigen::Index>(quarter, 1))));
        for (Eigen::Index r = 0; r < group.rows.rows(); ++r) {
            const Line line = line_through(group.rows.row(r).segment(from, middle).transpose());
            if (line.samples < 3) continue;
            for (Eigen::Index f = 0; f < length; ++f) {
                const double value = group.rows(r, plateau.first + f);
                if (!std::isfinite(value)) continue;
                const double allowed = off_line * line.sd + 0.5 * range;
                off[f] = std::max(off[f], std::abs(value - line.mean) / std::max(allowed, 1e-300));
            }
        }
    }
    while (plateau.last - plateau.first > middle && off[plateau.last - 1 - (plateau.first)] > 1 &&
           plateau.last - 1 > from + middle)
        --plateau.last;
    Eigen::Index cut = 0;
    while (cut < quarter && off[cut] > 1) ++cut;
    plateau.first += cut;
    return plateau;
}

}  // namespace

std::vector<Plateau> find_plateaus(const Eigen::VectorXd& times, const std::vector<SignalGroup>& groups,
                                   const PlateauOptions& options) {
    const auto frames = times.size();
    if (frames < 3 || groups.empty()) return {};
    const double interval = interval_of(times);
    const double whole = times[frames - 1] - times[0];
    const double shortest = options.shortest > 0 ? options.shortest : std::min(std::max(10 * interval, 0.3), whole / 5);
    const auto window = std::clamp<Eigen::Index>(
        interval > 0 ? static_cast<Eigen::Index>(std::lround(shortest / interval)) : 10, 3, frames);

    std::vector<char> in_plateau(static_cast<std::size_t>(frames), 0);
    std::vector<std::vector<char>> still;
    still.reserve(groups.size());
    for (const SignalGroup& group : groups)
        still.push_back(still_windows(group, window, options.still, still.empty() ? options.within : std::nullopt));
    for (Eigen::Index w = 0; w + window <= frames; ++w)
        if (std::ranges::all_of(still, [&](const std::vector<char>& of) { return of[w] != 0; }))
            std::fill_n(in_plateau.begin() + w, window, 1);

    std::vector<Plateau> plateaus;
    for (Eigen::Index f = 0; f < frames; ++f) {
        if (in_plateau[f] == 0) continue;
        if (plateaus.empty() || plateaus.back().last != f) plateaus.push_back({f, f});
        plateaus.back().last = f + 1;
    }
    for (Plateau& plateau : plateaus) plateau = trimmed(plateau, groups, options.still, options.within);
    return plateaus;
}

SteadyValue steady_value(const Eigen::Ref<const Eigen::VectorXd>& samples) {
    const Line line = line_through(samples);
    SteadyValue value{.mean = line.mean, .sigma = 0, .drift = 0, .samples = line.samples};
    if (line.samples < 2) return value;
    value.drift = line.slope * static_cast<double>(samples.size() - 1);

    double before = std::nan(""), products = 0, squares = 0, smallest = 0, last = std::nan("");
    for (Eigen::Index i = 0; i < samples.size(); ++i) {
        if (!std::isfinite(samples[i])) continue;
        const double off = samples[i] - line.at(static_cast<double>(i)), step = std::abs(samples[i] - last);
        squares += off * off;
        if (std::isfinite(before)) products += before * off;
        if (step > 0 && (smallest == 0 || step < smallest)) smallest = step;
        before = off;
        last = samples[i];
    }
    const double r = squares > 0 ? std::clamp(products / squares, 0.0, 0.99) : 0;
    const double independent = std::max(1.0, line.samples * (1 - r) / (1 + r));
    // a grid of values: the smallest step is its spacing where steps are whole numbers of it, else far below the noise
    const double rounding = smallest > line.sd ? smallest / std::sqrt(12.0) : 0;
    value.sigma = std::sqrt(line.sd * line.sd / independent + rounding * rounding + value.drift * value.drift / 12);
    return value;
}

Plateau settled_part(const Plateau& plateau, const std::vector<SignalGroup>& groups) {
    double drift = 0, scatter = 0;
    for (const SignalGroup& group : groups)
        for (Eigen::Index r = 0; r < group.rows.rows(); ++r) {
            const Eigen::Index length = plateau.last - plateau.first;
            const Line line = line_through(group.rows.row(r).segment(plateau.first, length).transpose());
            drift += std::pow(line.slope * static_cast<double>(length - 1), 2);
            scatter += line.sd * line.sd;
        }
    // sqrt(12): a line that rises by d has an rms of d / sqrt(12) about its mean
    if (drift <= 12 * scatter) return plateau;
    const Eigen::Index quarter = std::max<Eigen::Index>(2, (plateau.last - plateau.first) / 4);
    return {std::max(plateau.first, plateau.last - quarter), plateau.last};
}

}  // namespace palpate::identify
