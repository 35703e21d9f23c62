#include "identify/recordings/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::identify {
namespace {

constexpr std::size_t most_listed = 40;  // points or channels; of more the first ones

/// "1160, from 0 to 5.795 s, 200 a second"
std::string frames_in_words(const Recording& recording) {
    const Eigen::VectorXd& times = recording.times;
    const Eigen::Index n = times.size();
    if (n == 0) return "none";
    if (!recording.has_clock) return fmt::format("{}, no clock", n);
    std::string text = fmt::format("{}, from {:.6g} to {:.6g} s", n, times[0], times[n - 1]);
    if (n < 2 || !(times[n - 1] > times[0])) return text;
    Eigen::VectorXd steps = times.tail(n - 1) - times.head(n - 1);
    std::ranges::sort(steps);
    const double middle = steps[(n - 2) / 2];
    constexpr double jitter = 0.1;  // of a step: clocks are written with few digits, which their mean evens out
    const double least = steps[0], most = steps[n - 2], mean = (times[n - 1] - times[0]) / static_cast<double>(n - 1);
    const bool is_steady = most <= (1 + jitter) * middle && least >= (1 - jitter) * middle;
    if (middle > 0) text += fmt::format(", {:.5g} a second", 1 / (is_steady ? mean : middle));
    if (!is_steady) text += fmt::format(", not steady (steps of {:.3g} to {:.3g} s)", least, most);
    return text;
}

Eigen::Index seen_in(const RecordedPoint& point) {
    Eigen::Index seen = 0;
    for (Eigen::Index f = 0; f < point.at.cols(); ++f) seen += point.at.col(f).allFinite();
    return seen;
}

/// Widths so that columns stand below each other; UTF-8's longer characters may shift them by one.
std::string padded(const std::string& text, std::size_t width) {
    return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
}

std::size_t name_width(std::size_t longest) {
    constexpr std::size_t least = 8, most = 40;  // characters: the table stays readable
    return std::clamp(longest, least, most) + 2;
}

std::string points_in_words(const Recording& recording) {
    const char* unit = recording.in_pixels ? "pixel" : "mm";
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    Eigen::Index seen = 0, all = 0;
    std::size_t longest = 0;
    for (const RecordedPoint& point : recording.points) {
        longest = std::max(longest, point.name.size());
        all += point.at.cols();
        seen += seen_in(point);
        for (Eigen::Index f = 0; f < point.at.cols(); ++f) {
            if (!point.at.col(f).allFinite()) continue;
            low = low.cwiseMin(point.at.col(f));
            high = high.cwiseMax(point.at.col(f));
        }
    }
    std::string text = fmt::format("  points    {}", recording.points.size());
    if (all > 0)
        text += fmt::format(", {:.3g} % missing", 100 * static_cast<double>(all - seen) / static_cast<double>(all));
    if (seen > 0)
        text += fmt::format(", in a box of {:.4g} x {:.4g} x {:.4g} {}", high[0] - low[0], high[1] - low[1],
                            high[2] - low[2], unit);
    if (recording.points[0].displacement.cols() > 0) text += ", with displacements";
    const std::size_t width = name_width(longest);
    text += fmt::format("\n    {}{:>9}  first seen at x, y, z [{}]\n", padded("name", width), "missing", unit);
    for (std::size_t p = 0; p < std::min(recording.points.size(), most_listed); ++p) {
        const RecordedPoint& point = recording.points[p];
        const Eigen::Index frames = point.at.cols(), found = seen_in(point);
        text += fmt::format("    {}{:>7.3g} %", padded(point.name, width),
                            frames > 0 ? 100 * static_cast<double>(frames - found) / static_cast<double>(frames) : 100);
        for (Eigen::Index f = 0; f < frames && found > 0; ++f)
            if (point.at.col(f).allFinite()) {
                text += fmt::format("  {:.6g}, {:.6g}, {:.6g}", point.at(0, f), point.at(1, f), point.at(2, f));
                break;
            }
        text += '\n';
    }
    if (recording.points.size() > most_listed)
        text += fmt::format("    ... and {} more\n", recording.points.size() - most_listed);
    return text;
}

std::string channels_in_words(const Recording& recording) {
    std::size_t longest = 0;
    for (const RecordedChannel& channel : recording.channels) longest = std::max(longest, channel.name.size());
    const std::size_t width = name_width(longest);
    std::string text = fmt::format("  channels  {}\n    {}{:<8}{:>9}{:>13}{:>13}\n", recording.channels.size(),
                                   padded("name", width), "unit", "missing", "least", "most");
    for (std::size_t c = 0; c < std::min(recording.channels.size(), most_listed); ++c) {
        const RecordedChannel& channel = recording.channels[c];
        double least = std::numeric_limits<double>::infinity(), most = -least;
        Eigen::Index missing = 0;
        for (const double value : channel.values) {
            if (!std::isfinite(value))
                ++missing;
            else
                least = std::min(least, value), most = std::max(most, value);
        }
        const double share = channel.values.size() > 0
                                 ? 100 * static_cast<double>(missing) / static_cast<double>(channel.values.size())
                                 : 100;
        text += fmt::format("    {}{}{:>7.3g} %", padded(channel.name, width),
                            padded(channel.unit.empty() ? "?" : channel.unit, 8), share);
        if (least <= most) text += fmt::format("{:>13.5g}{:>13.5g}", least, most);
        text += '\n';
    }
    if (recording.channels.size() > most_listed)
        text += fmt::format("    ... and {} more\n", recording.channels.size() - most_listed);
    return text;
}

}  // namespace

std::string describe(const Recording& recording) {
    std::string text =
        fmt::format("{}: {}\n  frames    {}\n", recording.source, recording.format, frames_in_words(recording));
    if (!recording.points.empty()) text += points_in_words(recording);
    if (!recording.channels.empty()) text += channels_in_words(recording);
    if (!recording.events.empty()) {
        text += fmt::format("  events    {}\n", recording.events.size());
        for (const RecordedEvent& event : recording.events)
            text += fmt::format("    {:.6g} s  {}\n", event.time, event.name);
    }
    if (!recording.notes.empty()) text += "  found\n";
    for (const std::string& note : recording.notes) text += fmt::format("    {}\n", note);
    return text;
}

}  // namespace palpate::identify
