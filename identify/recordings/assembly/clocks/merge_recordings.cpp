#include "identify/recordings/assembly/clocks/merge_recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "identify/recordings/assembly/clocks/common_column.h"
#include "identify/recordings/assembly/clocks/lag.h"
#include "identify/recordings/assembly/clocks/triggers.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

const RecordedChannel* channel_of(const std::vector<Recording>& recordings, const std::string& name,
                                  const Recording*& of) {
    for (const Recording& recording : recordings)
        for (const RecordedChannel& channel : recording.channels)
            if (channel.name == name) {
                of = &recording;
                return &channel;
            }
    return nullptr;
}

/// Edges of a trigger, or events of its name.
std::vector<double> trigger_times(const std::vector<Recording>& recordings, const ClockRule& rule, double& interval) {
    const Recording* of = nullptr;
    if (const RecordedChannel* channel = channel_of(recordings, rule.channel, of)) {
        interval = interval_of(of->times);
        return edges_of({of->times, channel->values}, rule.rising, rule.level);
    }
    std::vector<double> times;
    for (const Recording& recording : recordings)
        for (const RecordedEvent& event : recording.events)
            if (event.name == rule.channel) times.push_back(event.time);
    std::ranges::sort(times);
    interval = 0;
    return times;
}

/// Merges the files of one probe.
class ProbeMerge {
public:
    ProbeMerge(const ImportMap& map, int number, std::vector<ClockReport>& clocks) : map_(map), clocks_(clocks) {
        probe_.probe = number;
    }

    ProbeRecording merged(std::vector<FileRecordings*> files) {
        // the points' clock is everybody's; without points the first file's is
        const auto shows_points = [](const FileRecordings* file) {
            return std::ranges::any_of(file->recordings, [](const Recording& r) { return !r.points.empty(); });
        };
        std::stable_partition(files.begin(), files.end(), shows_points);
        reference_ = files.front();
        begin();
        for (FileRecordings* file : files) {
            probe_.files.push_back(file->name);
            const std::vector<MappedValue>& values = file->mapped->values;
            probe_.values.insert(probe_.values.end(), values.begin(), values.end());
            probe_.values_act_always = probe_.values_act_always || file->mapped->values_act_always;
        }
        add(*reference_, [](double t) { return t; });
        for (std::size_t i = 1; i < files.size(); ++i)
            if (shares_frames(*files[i])) add_frame_by_frame(*files[i]);
        add_quantities(map_, probe_);
        for (std::size_t i = 1; i < files.size(); ++i)
            if (!shares_frames(*files[i])) add_by_rule(*files[i]);
        from_zero();
        return std::move(probe_);
    }

private:
    void begin() {
        const auto with_points =
            std::ranges::find_if(reference_->recordings, [](const Recording& r) { return !r.points.empty(); });
        const Recording& first =
            with_points == reference_->recordings.end() ? reference_->recordings.front() : *with_points;
        probe_.times = first.times;
        probe_.has_clock = first.has_clock;
        // of points in a plane a file tells no third coordinate, or a 0 for it
        probe_.is_planar = !first.points.empty() && std::ranges::all_of(first.points, [](const RecordedPoint& point) {
            return (point.at.row(2).array().isNaN() || point.at.row(2).array() == 0).all();
        });
    }

    /// All of a file, at times that `on_clock` makes of its own (NaN: not on this clock).
    template <class OnClock>
    void add(const FileRecordings& file, const OnClock& on_clock) {
        for (const Recording& recording : file.recordings) {
            Eigen::VectorXd times = recording.times;
            for (double& t : times) t = on_clock(t);
            for (const RecordedPoint& point : recording.points) add_point(point, times, file.name);
            for (const RecordedChannel& channel : recording.channels) {
                // each file has what clocks are merged by
                if (channel.name == map_.clock.channel && probe_.channel(channel.name)) continue;
                if (probe_.channel(channel.name))
                    throw InvalidInput(
                        fmt::format("{}: two channels of probe {} are called {}. Give one another name in "
                                    "the map: channels: - {{column: ..., name: ...}}.",
                                    file.name, probe_.probe, mesh::cited(channel.name)));
                probe_.channels.push_back({channel.name, channel.unit, without_gaps({times, channel.values})});
            }
        }
    }

    void add_point(const RecordedPoint& point, const Eigen::VectorXd& times, const std::string& file) {
        if (probe_.point(point.name))
            throw InvalidInput(
                fmt::format("{}: two points of probe {} are called {}. Name them in the map: names: [...].", file,
                            probe_.probe, mesh::cited(point.name)));
        if (times.size() == probe_.times.size() && times == probe_.times) {
            probe_.points.push_back(point);
            return;
        }
        RecordedPoint resampled{.name = point.name, .at = Eigen::Matrix3Xd(3, probe_.times.size()), .displacement = {}};
        for (int axis = 0; axis < 3; ++axis) {
            const Signal signal = without_gaps({times, point.at.row(axis).transpose()});
            for (Eigen::Index f = 0; f < probe_.times.size(); ++f)
                resampled.at(axis, f) = value_at(signal, probe_.times[f]);
        }
        probe_.points.push_back(std::move(resampled));
    }

    /// Neither has a clock, and both have as many frames.
    bool shares_frames(const FileRecordings& file) const {
        return !probe_.has_clock && std::ranges::none_of(file.recordings, [&](const Recording& recording) {
            return recording.has_clock || recording.times.size() != probe_.times.size() ||
                   recording.times != probe_.times;
        });
    }

    void add_frame_by_frame(const FileRecordings& file) {
        clocks_.push_back({file.name, "frame by frame, as both have no clock and as many frames", probe_.probe});
        add(file, [](double t) { return t; });
    }

    void add_by_rule(const FileRecordings& file) {
        switch (map_.clock.kind) {
            case ClockRule::Kind::trigger:
                return add_by_fit(file, by_trigger(file), fmt::format("by the edges of '{}'", map_.clock.channel));
            case ClockRule::Kind::common:
                return add_by_common(file);
            case ClockRule::Kind::lag:
                if (map_.clock.lag)
                    return add_by_fit(file, {.offset = *map_.clock.lag}, "by the lag that the map tells");
                return add_by_fit(file, by_lag(file), "by the lag at which force and motion agree best");
        }
    }

    void add_by_fit(const FileRecordings& file, const ClockFit& clock, const std::string& how) {
        clocks_.push_back({file.name, how, probe_.probe, clock.offset, clock.rate, clock.sd});
        add(file, [&](double t) { return clock.offset + clock.rate * t; });
    }

    ClockFit by_trigger(const FileRecordings& file) const {
        double interval = 0, other_interval = 0;
        const std::vector<double> reference = trigger_times(reference_->recordings, map_.clock, interval),
                                  other = trigger_times(file.recordings, map_.clock, other_interval);
        const auto fit = match_edges(reference, other, interval, other_interval);
        if (!fit)
            throw InvalidInput(fmt::format(
                "{}: the trigger '{}' has {} edges here and {} in {}, which cannot be paired in one way. Tell its "
                "level and "
                "edge (clock: {{trigger: ..., edge: rising, level: ...}}), or merge by clock: {{lag: auto}}.",
                file.name, map_.clock.channel, other.size(), reference.size(), reference_->name));
        return *fit;
    }

    /// The motion that forces are compared with: told, or that of all points.
    Signal motion() const {
        if (!map_.clock.motion.empty()) {
            const NamedSignal* told = probe_.channel(map_.clock.motion);
            if (!told)
                throw InvalidInput(fmt::format("{}: clock.motion names {}, and {} has no such channel or quantity.",
                                               map_.file.filename().string(), mesh::cited(map_.clock.motion),
                                               reference_->name));
            return without_gaps(told->signal);
        }
        if (!probe_.points.empty()) return without_gaps(leading_motion(probe_));
        for (const MappedUse& use : map_.uses)
            if (const NamedSignal* used = probe_.channel(use.channel)) return without_gaps(used->signal);
        return probe_.channels.empty() ? Signal{} : without_gaps(probe_.channels.front().signal);
    }

    /// A channel of another file that the map uses, or its first one.
    Signal force_of(const FileRecordings& file) const {
        const Recording* of = nullptr;
        std::vector<std::string> names{map_.clock.force};
        for (const MappedUse& use : map_.uses) names.push_back(use.channel);
        for (const std::string& name : names)
            if (const RecordedChannel* channel = name.empty() ? nullptr : channel_of(file.recordings, name, of))
                return without_gaps({of->times, channel->values});
        for (const Recording& recording : file.recordings)
            if (!recording.channels.empty()) return without_gaps({recording.times, recording.channels.front().values});
        // another tracking system
        for (const Recording& recording : file.recordings) {
            ProbeRecording other;
            other.times = recording.times;
            other.points = recording.points;
            return without_gaps(leading_motion(other));
        }
        return {};
    }

    ClockFit by_lag(const FileRecordings& file) const {
        const Signal moved = motion(), force = force_of(file);
        if (std::min(moved.times.size(), force.times.size()) < 10)
            throw InvalidInput(
                fmt::format("{}: {} samples are too few to find its lag behind {} by. Tell it (clock: {{lag: "
                            "0.1}}).",
                            file.name, std::min(moved.times.size(), force.times.size()), reference_->name));
        const LagEstimate estimate = estimate_lag(moved, force);
        if (!estimate.is_clear)
            throw InvalidInput(
                fmt::format("{}: at which lag it agrees with {} is not clear: their correlation is {:.2f} at {:.4g} s, "
                            "and {:.2f} at "
                            "{:.4g} s. Give both a trigger (clock: {{trigger: CHANNEL}}), a common column (clock: "
                            "{{common: CHANNEL}}), "
                            "or tell the lag in seconds (clock: {{lag: 0.1}}).",
                            file.name, reference_->name, estimate.correlation, estimate.clock.offset, estimate.rival,
                            estimate.rival_lag));
        return estimate.clock;
    }

    /// Both sides tell the same quantity, which rises or falls: its values are the clock.
    void add_by_common(const FileRecordings& file) {
        const std::string& name = map_.clock.channel;
        const NamedSignal* here = probe_.channel(name);
        const Recording* of = nullptr;
        const RecordedChannel* there = channel_of(file.recordings, name, of);
        const Signal other = there ? without_gaps({of->times, there->values}) : Signal{};
        const Signal own = here ? without_gaps(here->signal) : Signal{};
        if (own.values.size() < 2 || other.values.size() < 2)
            throw InvalidInput(
                fmt::format("{}: the common column {} is not in {}. Each file of a probe needs it, or a "
                            "quantity of its points (quantities).",
                            file.name, mesh::cited(name), own.values.size() < 2 ? reference_->name : file.name));
        const Signal clock = clock_by_common(name, {reference_->name, own}, {file.name, other});
        clocks_.push_back({file.name, fmt::format("by the common column '{}'", name), probe_.probe});
        FileRecordings rest = file;
        for (Recording& recording : rest.recordings)
            std::erase_if(recording.channels, [&](const RecordedChannel& channel) { return channel.name == name; });
        add(rest, [&](double t) { return value_at(clock, t); });
    }

    void from_zero() {
        const double first = probe_.times[0];
        probe_.times.array() -= first;
        for (NamedSignal& channel : probe_.channels) channel.signal.times.array() -= first;
        for (ClockReport& clock : clocks_)
            if (clock.probe == probe_.probe) clock.offset -= first;
    }

    const ImportMap& map_;
    std::vector<ClockReport>& clocks_;
    FileRecordings* reference_ = nullptr;
    ProbeRecording probe_;
};

}  // namespace

std::vector<ProbeRecording> merge_recordings(const ImportMap& map, std::vector<FileRecordings> files,
                                             std::vector<ClockReport>& clocks) {
    std::map<int, std::vector<FileRecordings*>> of_probe;
    for (FileRecordings& file : files) of_probe[file.mapped->probe].push_back(&file);
    std::vector<ProbeRecording> probes;
    probes.reserve(of_probe.size());
    for (auto& [number, of] : of_probe) probes.push_back(ProbeMerge(map, number, clocks).merged(of));
    return probes;
}

}  // namespace palpate::identify
