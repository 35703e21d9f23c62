#include "identify/recordings/files/c3d/read_c3d.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "identify/recordings/files/c3d/c3d_bytes.h"
#include "identify/recordings/files/c3d/c3d_parameters.h"
#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/text/cell.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double nan = not_seen;
constexpr std::size_t block = 512;  // [bytes]

/// What the frames look like: each holds its points, then its analog samples.
struct C3dLayout {
    std::size_t points = 0, channels = 0, samples = 0;  // samples: of a channel in a frame
    bool is_real = false;
    double scale = 1;                // of integers
    double rate = 0;                 // of frames [1/s]
    double first = 1;                // number of the first frame
    std::size_t frames = 0, at = 0;  // at: the byte of the first one

    std::size_t number_size() const { return is_real ? 4 : 2; }
    std::size_t frame_size() const { return number_size() * (4 * points + channels * samples); }
};

/// Frames that the file announces: 16 bits in the header are not enough for long files, which tell it elsewhere.
double announced_frames(const C3dBytes& bytes, const C3dParameters& parameters) {
    const auto& first = parameters.numbers("TRIAL:ACTUAL_START_FIELD");
    const auto& last = parameters.numbers("TRIAL:ACTUAL_END_FIELD");
    constexpr double half = 65536;  // 2^16: words of 16 bits
    const auto joined = [](const std::vector<double>& words) {
        const auto word = [](double value) { return value < 0 ? value + half : value; };
        return word(words[0]) + half * word(words[1]);
    };
    if (first.size() == 2 && last.size() == 2) return joined(last) - joined(first) + 1;
    if (const double told = parameters.number("POINT:LONG_FRAMES", 0); told > 0) return std::floor(told);
    const double in_header = bytes.word(8) - bytes.word(6) + 1;
    double told = parameters.number("POINT:FRAMES", 0);
    if (told < 0) told += half;
    return std::max(in_header, told);
}

C3dLayout layout_of(const C3dBytes& bytes, const C3dParameters& parameters) {
    constexpr double most_points = 65535;  // a word of 16 bits
    const auto checked = [&](const char* name, double value, double least, double most) {
        if (!(value >= least && value <= most) || value != std::floor(value))
            throw InvalidInput(
                fmt::format("{}: {} is {}; a whole number from {:.0f} to {:.0f} is allowed. The file is "
                            "broken: export it again.",
                            bytes.name(), name, value, least, most));
        return static_cast<std::size_t>(value);
    };
    const auto unsigned_number = [&](const char* name, double otherwise) {
        const double value = parameters.number(name, otherwise);
        return value < 0 ? value + 65536 : value;
    };
    C3dLayout layout;
    layout.points = checked("POINT:USED", unsigned_number("POINT:USED", bytes.word(2)), 0, most_points);
    const double in_frame = bytes.word(4);  // analog numbers in a frame
    layout.channels = checked("ANALOG:USED", unsigned_number("ANALOG:USED", 0), 0, most_points);
    if (in_frame == 0) layout.channels = 0;
    if (layout.channels > 0) {
        layout.samples = static_cast<std::size_t>(in_frame) / layout.channels;
        if (layout.samples * layout.channels != static_cast<std::size_t>(in_frame))
            throw InvalidInput(
                fmt::format("{}: {} analog numbers a frame are no multiple of its {} channels. The file is "
                            "broken: export it again.",
                            bytes.name(), in_frame, layout.channels));
    } else if (in_frame > 0) {
        throw InvalidInput(
            fmt::format("{}: {} analog numbers a frame, but no channel is named (ANALOG:USED). The file is "
                        "broken: export it again.",
                        bytes.name(), in_frame));
    }
    const double scale = parameters.number("POINT:SCALE", static_cast<double>(bytes.real(12)));
    layout.is_real = scale < 0;
    layout.scale = std::abs(scale);
    layout.rate = parameters.number("POINT:RATE", static_cast<double>(bytes.real(20)));
    layout.first = bytes.word(6);
    double start = parameters.number("POINT:DATA_START", bytes.word(16));
    if (start == 0) start = bytes.word(16);  // some programs tell it in the header alone
    const std::size_t start_block = checked("POINT:DATA_START", start < 0 ? start + 65536 : start, 2, 65535);
    layout.at = block * (start_block - 1);

    if (layout.frame_size() == 0)
        throw InvalidInput(fmt::format("{}: holds neither points nor analogs.", bytes.name()));
    layout.frames = checked("the number of frames", announced_frames(bytes, parameters), 1, 1e9);
    const std::size_t held = layout.at < bytes.size() ? (bytes.size() - layout.at) / layout.frame_size() : 0;
    constexpr std::size_t most_in_header = 65535;                                       // a word of 16 bits
    if (layout.frames == most_in_header && held > layout.frames) layout.frames = held;  // it tells no more
    if (held < layout.frames)
        throw InvalidInput(
            fmt::format("{}: announces {} frames of {} bytes, but holds {}. The file is cut off: export it "
                        "again.",
                        bytes.name(), layout.frames, layout.frame_size(), held));
    return layout;
}

/// A label that is not another one's, and not empty.
std::string own_label(std::string label, std::size_t index, std::set<std::string>& taken) {
    if (label.empty()) label = fmt::format("{}", index + 1);
    if (!taken.insert(label).second) {
        label += fmt::format(" ({})", index + 1);
        taken.insert(label);
    }
    return label;
}

/// Points that are none: angles, forces and the like of a model, which are stored as such.
std::set<std::string> other_quantities(const C3dParameters& parameters) {
    std::set<std::string> names;
    for (const char* kind :
         {"POINT:ANGLES", "POINT:FORCES", "POINT:MOMENTS", "POINT:POWERS", "POINT:SCALARS", "POINT:REACTIONS"})
        for (const std::string& name : parameters.texts(kind)) names.insert(name);
    return names;
}

/// Labels of so many, and at least the first are told.
std::vector<std::string> labels_of(const C3dParameters& parameters, const char* name, std::size_t count) {
    std::vector<std::string> labels = parameters.texts(name);
    labels.resize(count);
    return labels;
}

Recording read_points(const C3dBytes& bytes, const C3dParameters& parameters, const C3dLayout& layout,
                      const FileMap& map) {
    Recording recording = begun(bytes.name(), "C3D, points");
    const double factor = position_factor(map, parameters.text("POINT:UNITS"), bytes.name(), recording);
    const auto frames = static_cast<Eigen::Index>(layout.frames);
    const auto labels = labels_of(parameters, "POINT:LABELS", layout.points);
    const auto others = other_quantities(parameters);
    std::set<std::string> taken;
    int left_out = 0;
    Eigen::Index zeros = 0;
    for (std::size_t p = 0; p < layout.points; ++p) {
        if (!labels[p].empty() && others.contains(labels[p])) {
            ++left_out;
            continue;
        }
        RecordedPoint point{own_label(labels[p], p, taken), Eigen::Matrix3Xd::Constant(3, frames, not_seen), {}};
        for (std::size_t f = 0; f < layout.frames; ++f) {
            const std::size_t size = layout.number_size(), at = layout.at + f * layout.frame_size() + p * 4 * size;
            const auto number = [&](std::size_t i) {
                return layout.is_real ? static_cast<double>(bytes.real(at + i * size)) : bytes.integer(at + i * size);
            };
            if (!(number(3) >= 0)) continue;  // the residual
            const Eigen::Vector3d value(number(0), number(1), number(2));
            if (!value.allFinite() || value.cwiseAbs().maxCoeff() > mesh::beyond_all_units) continue;
            // No tracker sees a point at 0, 0, 0 exactly; exporters write it for one that was not seen.
            if (value.isZero(0)) {
                ++zeros;
                continue;
            }
            point.at.col(static_cast<Eigen::Index>(f)) = factor * (layout.is_real ? 1 : layout.scale) * value;
        }
        recording.points.push_back(std::move(point));
    }
    if (left_out > 0)
        recording.notes.push_back(
            fmt::format("{} labels are angles, forces or the like of a model: left out", left_out));
    if (zeros > 0) recording.notes.push_back(fmt::format("{} positions of 0, 0, 0: taken as not seen", zeros));
    return recording;
}

Recording read_analogs(const C3dBytes& bytes, const C3dParameters& parameters, const C3dLayout& layout) {
    Recording recording = begun(bytes.name() + ", analogs", "C3D, analogs");
    const auto labels = labels_of(parameters, "ANALOG:LABELS", layout.channels);
    const auto units = labels_of(parameters, "ANALOG:UNITS", layout.channels);
    std::vector<double> scales = parameters.all_numbers("ANALOG:SCALE"),
                        offsets = parameters.all_numbers("ANALOG:OFFSET");
    scales.resize(layout.channels, 1);
    offsets.resize(layout.channels, 0);
    const double scale = parameters.number("ANALOG:GEN_SCALE", 1);
    const bool is_unsigned = parameters.text("ANALOG:FORMAT") == "UNSIGNED";
    const auto samples = static_cast<Eigen::Index>(layout.frames * layout.samples);
    std::set<std::string> taken;
    for (std::size_t c = 0; c < layout.channels; ++c) {
        Eigen::VectorXd values(samples);
        const double offset = is_unsigned && offsets[c] < 0 ? offsets[c] + 65536 : offsets[c];
        for (std::size_t s = 0; s < layout.frames * layout.samples; ++s) {
            const std::size_t size = layout.number_size();
            const std::size_t at = layout.at + (s / layout.samples) * layout.frame_size() +
                                   size * (4 * layout.points + (s % layout.samples) * layout.channels + c);
            double raw = layout.is_real ? static_cast<double>(bytes.real(at)) : bytes.integer(at);
            if (!layout.is_real && is_unsigned && raw < 0) raw += 65536;
            const double value = (raw - offset) * scales[c] * scale;
            values[static_cast<Eigen::Index>(s)] = std::abs(value) < mesh::beyond_all_units ? value : not_seen;
        }
        recording.channels.push_back(in_our_units(own_label(labels[c], c, taken), units[c], std::move(values)));
    }
    return recording;
}

/// Those of the group EVENT, else those of the header.
std::vector<RecordedEvent> read_events(const C3dBytes& bytes, const C3dParameters& parameters) {
    std::vector<RecordedEvent> events;
    const auto labels = parameters.texts("EVENT:LABELS"), contexts = parameters.texts("EVENT:CONTEXTS");
    const auto times = parameters.all_numbers("EVENT:TIMES");  // minutes and seconds
    for (std::size_t e = 0; 2 * e + 1 < times.size() && e < labels.size(); ++e) {
        const bool has_context = e < contexts.size() && !contexts[e].empty();
        events.push_back({(has_context ? contexts[e] + " " : "") + labels[e], 60 * times[2 * e] + times[2 * e + 1]});
    }
    constexpr std::size_t key_at = 298, count_at = 300, times_at = 304, labels_at = 396;  // [bytes]
    constexpr int key = 12345, most = 18;  // of the format: what marks labels of four letters, and events of a header
    if (!events.empty() || bytes.word(key_at) != key) return events;
    for (std::size_t e = 0; e < static_cast<std::size_t>(std::min(bytes.word(count_at), most)); ++e)
        events.push_back({std::string(trimmed(bytes.text(labels_at + 4 * e, 4))),
                          static_cast<double>(bytes.real(times_at + 4 * e))});
    std::erase_if(events, [](const RecordedEvent& event) { return !std::isfinite(event.time); });
    return events;
}

}  // namespace

bool is_c3d(const std::string& bytes) {
    constexpr char magic = 0x50;
    return bytes.size() >= block && bytes[1] == magic && bytes[0] >= 2 && bytes.find('\0') < block;
}

std::vector<Recording> read_c3d(const std::string& bytes, const std::filesystem::path& file, const FileMap& map) {
    const C3dBytes in(bytes, file);
    in.require(0, block);
    const C3dParameters parameters(in);
    const C3dLayout layout = layout_of(in, parameters);
    const double rate = map.rate.value_or(layout.rate);
    const double first = std::max(layout.first - 1, 0.0);

    std::vector<Recording> recordings;
    if (layout.points > 0) recordings.push_back(read_points(in, parameters, layout, map));
    if (layout.channels > 0) recordings.push_back(read_analogs(in, parameters, layout));
    for (Recording& recording : recordings) {
        const bool is_analog = recording.points.empty() && !recording.channels.empty();
        const double factor = is_analog ? static_cast<double>(layout.samples) : 1;
        const auto frames = static_cast<Eigen::Index>(layout.frames * (is_analog ? layout.samples : 1));
        if (rate > 0 && std::isfinite(rate)) {
            set_rate(rate * factor, frames, first * factor, recording);
        } else {
            set_no_clock(frames, recording);
            recording.notes.emplace_back("the file tells no rate: 'rate' in a map does");
        }
        if (layout.first > 1)
            recording.notes.push_back(
                fmt::format("the first frame is number {}; the clock begins with number 1", layout.first));
        static constexpr const char* processors[]{"Intel", "DEC", "MIPS"};
        recording.notes.push_back(fmt::format("{}, {}", processors[static_cast<int>(in.processor())],
                                              layout.is_real ? "real numbers" : "integers"));
    }
    if (!recordings.empty()) recordings[0].events = read_events(in, parameters);
    if (layout.points > 0) name_points(map, in.name(), recordings[0]);
    return recordings;
}

}  // namespace palpate::identify
