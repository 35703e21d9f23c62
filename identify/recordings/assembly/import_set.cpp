#include "identify/recordings/assembly/import_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "identify/recordings/assembly/clocks/merge_recordings.h"
#include "identify/recordings/assembly/fill_set.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "identify/recordings/assembly/map/map_entries.h"
#include "identify/recordings/assembly/register_states.h"
#include "identify/recordings/assembly/tracks/mend_tracks.h"
#include "identify/recordings/assembly/tracks/name_points.h"
#include "identify/recordings/files/read_recordings.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

/// Folders in which files lie that the map names.
std::vector<fs::path> folders_of(const std::vector<fs::path>& files) {
    std::vector<fs::path> folders;
    for (const fs::path& file : files) {
        if (!fs::exists(file)) throw IoError(fmt::format("{}: no such file or folder.", file.string()));
        const fs::path folder = fs::is_directory(file) ? file : file.parent_path();
        if (std::ranges::find(folders, folder) == folders.end()) folders.push_back(folder);
    }
    return folders;
}

/// What was given on the command line has a meaning in the map, or is a slip.
void check_all_are_mapped(const ImportMap& map, const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
        if (fs::is_directory(file)) continue;
        const std::string name = file.filename().string();
        const auto is_named = [&](const MappedFile& mapped) { return names_file(mapped, name); };
        if (std::ranges::any_of(map.files, is_named)) continue;
        std::vector<std::string> names;
        names.reserve(map.files.size());
        for (const MappedFile& mapped : map.files) names.push_back(mapped.file);
        throw InvalidInput(
            fmt::format("{}: the map says nothing of this file{}; it names {}. Add an entry to 'files' in {}.",
                        file.string(), mesh::suggestion(name, names), mesh::listed(names), map.file.string()));
    }
}

/// Of a series the folder counts; a file has to be there.
fs::path located(const MappedFile& mapped, const std::vector<fs::path>& folders) {
    if (mapped.file.find('*') == std::string::npos && !mapped.how.series)
        return found_file(mapped.file, folders, mapped.where);
    for (const fs::path& folder : folders)
        if (fs::is_directory((folder / mapped.file).parent_path())) return folder / mapped.file;
    return mapped.file;
}

void check_times(const Recording& recording) {
    const auto& t = recording.times;
    bool is_sound = t.size() > 0 && t.allFinite();
    for (Eigen::Index i = 1; is_sound && i < t.size(); ++i) is_sound = t[i] > t[i - 1];
    if (!is_sound)
        throw InvalidInput(
            fmt::format("{}: its times do not rise from sample to sample. Tell the column of times, or a "
                        "'rate', in the map.",
                        recording.source));
}

std::vector<FileRecordings> read_files(const ImportMap& map, const ImportOptions& options,
                                       const std::vector<fs::path>& folders, std::vector<std::string>& notes) {
    std::vector<FileRecordings> files;
    files.reserve(map.files.size());
    for (const MappedFile& mapped : map.files) {
        FileMap how = mapped.how;
        if (!options.unit.empty()) how.unit = options.unit;
        FileRecordings& file = files.emplace_back();
        file.mapped = &mapped;
        file.name = mapped.file;
        file.recordings = read_recordings(located(mapped, folders), how);
        std::erase_if(file.recordings, [](const Recording& r) { return r.points.empty() && r.channels.empty(); });
        if (file.recordings.empty())
            throw InvalidInput(fmt::format("{}: the file {} holds neither points nor channels.", mapped.where,
                                           mesh::cited(mapped.file)));
        for (const Recording& recording : file.recordings) {
            check_times(recording);
            for (const std::string& note : recording.notes)
                notes.push_back(fmt::format("{}: {}.", recording.source, note));
        }
    }
    return files;
}

/// The middle of each point's track over its first frames.
Points first_places(const Recording& recording) {
    constexpr Eigen::Index frames = 20;  // a choice: their mean smooths noise, and the body has hardly moved yet
    Points places(std::ssize(recording.points), 3);
    for (Eigen::Index p = 0; p < places.rows(); ++p) {
        const Eigen::Matrix3Xd& at = recording.points[static_cast<std::size_t>(p)].at;
        for (int axis = 0; axis < 3; ++axis) {
            const SteadyValue mean = steady_value(at.row(axis).head(std::min(frames, at.cols())).transpose());
            places(p, axis) = mean.samples > 0 ? mean.mean : missing;
        }
    }
    return places;
}

/// Finds which point is which of the map's, by their distances.
void name_by_distances(const ImportMap& map, const std::string& file, Recording& recording, ImportReport& report) {
    constexpr std::size_t most_names = 12;  // beyond that trying all orders takes too long
    std::vector<const MappedPlace*> places;
    for (const MappedPlace& place : map.places)
        if (place.at) places.push_back(&place);
    if (places.size() < 3 || places.size() > most_names)
        throw InvalidInput(
            fmt::format("{}: its points are of unknown order, which is found by their distances: that takes 3 to "
                        "{} markers or fiducials with a place ('at'), and the map has {}.",
                        file, most_names, places.size()));
    Points wanted(std::ssize(places), 3);
    for (std::size_t i = 0; i < places.size(); ++i)
        wanted.row(static_cast<Eigen::Index>(i)) = places[i]->at->transpose();
    const PointNames names = name_points(first_places(recording), wanted);
    if (!names.is_clear)
        throw InvalidInput(fmt::format(
            "{}: which point is which of the map's is not clear: distances differ by {:.2g} % in the best order and by "
            "{:.2g} % in the next. Tell the order (names: [...]).",
            file, 100 * names.misfit, 100 * names.second));
    std::string told;
    std::vector<std::string> old;
    for (RecordedPoint& point : recording.points) {
        old.push_back(point.name);
        point.name = "stray " + point.name;
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (names.seen_of[i] < 0) continue;
        const auto seen = static_cast<std::size_t>(names.seen_of[i]);
        recording.points[seen].name = places[i]->name;
        told += fmt::format("{}{} is '{}'", told.empty() ? "" : ", ", old[seen], places[i]->name);
    }
    report.notes.push_back(
        fmt::format("{}: by their distances, point {} (off by {:.2g} %, the next order by {:.2g} %).", file, told,
                    100 * names.misfit, 100 * names.second));
}

void mend(const ImportMap& map, std::vector<FileRecordings>& files, ImportReport& report) {
    for (FileRecordings& file : files)
        for (Recording& recording : file.recordings) {
            if (recording.points.empty()) continue;
            if (const std::string done = describe(mend_tracks(recording.points)); !done.empty())
                report.notes.push_back(fmt::format("{}: {}.", recording.source, done));
            if (file.mapped->is_unordered) name_by_distances(map, recording.source, recording, report);
        }
}

/// What the map names has to be somewhere.
void check_names(const ImportMap& map, const std::vector<ProbeRecording>& probes) {
    std::set<std::string> points, channels;
    for (const ProbeRecording& probe : probes) {
        for (const RecordedPoint& point : probe.points) points.insert(point.name);
        for (const NamedSignal& channel : probe.channels) channels.insert(channel.name);
        for (const MappedValue& value : probe.values) channels.insert(value.name);
    }
    const auto check = [](const std::string& where, const std::string& what, const std::string& name,
                          const std::set<std::string>& known) {
        if (known.contains(name)) return;
        const std::vector<std::string> names(known.begin(), known.end());
        constexpr std::size_t most_listed = 20;  // names in a message
        std::vector<std::string> listed = names;
        listed.resize(std::min(listed.size(), most_listed));
        throw InvalidInput(fmt::format(
            "{}: no file has a {} {}{}. There {}: {}{}.", where, what, mesh::cited(name), mesh::suggestion(name, names),
            names.empty() ? "is" : "are", names.empty() ? "none" : mesh::listed(listed),
            names.size() > most_listed ? fmt::format(" and {} more", names.size() - most_listed) : ""));
    };
    const std::string file = map.file.filename().string();
    for (const MappedPlace& place : map.places)
        check(file + (place.is_marker ? ", markers" : ", fiducials"), "point", place.name, points);
    for (const MappedUse& use : map.uses) {
        for (const std::string& point : use.points) check(use.where, "point", point, points);
        if (!use.channel.empty()) check(use.where, "channel", use.channel, channels);
    }
}

}  // namespace

ImportedSet import_set(const ImportOptions& options) {
    const std::vector<fs::path> folders = folders_of(options.files);
    ImportMap map = read_import_map(options.map, {options.mesh, folders});
    std::vector<fs::path> all_folders = folders;
    all_folders.push_back(options.map.parent_path());
    if (!options.states.empty()) parse_states(options.states, "--states", map.states);
    if (!options.registration.empty()) parse_register(options.registration, "--register", {"", map.set.folder}, map);
    map.states.plateaus.validate();
    check_all_are_mapped(map, options.files);

    ImportedSet imported;
    ImportReport& report = imported.report;
    std::vector<std::string> of_readers;
    std::vector<FileRecordings> files = read_files(map, options, all_folders, of_readers);
    mend(map, files, report);
    PlacesOfFiles places;
    for (const FileRecordings& file : files)
        for (const Recording& recording : file.recordings) add_places_at_rest(recording, places);
    const std::vector<ProbeRecording> recordings = merge_recordings(map, std::move(files), report.clocks);
    check_names(map, recordings);

    const double range = common_range(recordings);
    std::vector<ProbeStates> probes;
    probes.reserve(recordings.size());
    for (const ProbeRecording& recording : recordings) {
        probes.push_back({&recording, find_states(map, recording, range, report.notes)});
        report.probes.push_back({recording.probe, recording.files,
                                 recording.has_clock ? recording.times[recording.times.size() - 1] : 0,
                                 static_cast<int>(recording.points.size()), static_cast<int>(recording.channels.size()),
                                 static_cast<int>(probes.back().states.size())});
    }
    const RestState rest = rest_state(map, probes, places, report.notes);
    const StateFrames frames = register_states(map, probes, rest, report);
    imported.set = filled_set(map, probes, rest, frames, report);
    report.notes.insert(report.notes.end(), of_readers.begin(), of_readers.end());
    return imported;
}

}  // namespace palpate::identify
