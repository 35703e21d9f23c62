#include <fmt/format.h>

#include <algorithm>

#include "identify/recordings/assembly/import_set.h"
#include "identify/recordings/assembly/map/import_map.h"
#include "identify/recordings/describe.h"
#include "identify/recordings/files/draft_map.h"
#include "identify/recordings/files/read_recordings.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/import_options.h"
#include "pipeline/command_line/subcommands.h"

// From what a rig wrote to a measurement set.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

constexpr const char* map_head =
    "# What a rig wrote, as a measurement set: edit this, then 'palpate import FILE... --map map.yaml -o SET'.\n"
    "name: my-rig\n"
    "mesh: body.stl                 # the body at rest, beside this map or one of the files\n"
    "# mesh_unit: m                 # mm by default\n"
    "units: {length: mm, force: N}  # of the numbers in this map\n"
    "supports:                      # where the body is held, in the mesh's frame\n"
    "  - box: {min: [-1, -1, -1], max: [1, 21, 21]}\n";

constexpr const char* map_tail =
    "    # probe: 1            # files of one probe show the same body at the same time\n"
    "    # order: unknown      # which point is which is found by their distances\n"
    "    # values: {name: pressure, value: 10 kPa}    # what no file contains; acts where points have moved, or "
    "'while: always'\n"
    "\n"
    "# Points whose place on the mesh is known register the frames; markers without 'at' rest where the first state "
    "shows "
    "them.\n"
    "# markers: [{name: tip}, {name: side, at: [50, 10, 20]}]\n"
    "# fiducials: [{name: clamp-1, at: [0, 0, 0]}, {name: clamp-2, at: [0, 20, 0]}, {name: clamp-3, at: [0, 0, 20]}]\n"
    "register: auto                 # fiducials, icp (points on the surface), none, or a file of name,x,y,z\n"
    "# frame: {x: [1, 0, 0], y: [0, 0, 1]}        # the mesh's axes in the recording's frame; scale: true; each: "
    "state\n"
    "rest: auto                     # file: where displacements count from; first: the first state; none; or a "
    "probe's number\n"
    "states: plateaus               # every=0.5s, all\n"
    "# plateaus: {shortest: 0.5, within: 0.2}     # s, mm\n"
    "clock: {lag: auto}             # trigger: CHANNEL, common: CHANNEL, or lag: 0.1\n"
    "\n"
    "# What the channels are.\n"
    "# forces: [{at: [100, 10, 20], radius: 3, along: [0, 0, -1], channel: load}]\n"
    "# tools: [{name: punch, shape: {flat: {radius: 4}}, at: [50, 10, 21], contact: frictionless}]\n"
    "# motions: [{tool: punch, along: [0, 0, -1], channel: crosshead}]\n"
    "# reactions: [{tool: punch, along: [0, 0, -1], channel: load, tare: true}]\n"
    "# actuators: [{name: chamber, kind: pressure, cavity: {near: [50, 10, 10]}}]\n"
    "# actuations: [{actuator: chamber, channel: pressure}]\n"
    "# quantities: [{name: extension, points: [a], minus: [b], along: [1, 0, 0]}]\n";

/// "1 state", "2 states"
std::string number_of(std::size_t count, const char* thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// A file to describe, and what is told of it.
struct ToldFile {
    fs::path file;
    identify::FileMap how;
};

/// The files of the command line, of a folder those that the map names in it, with what map and options tell of them.
std::vector<ToldFile> told_files(const ImportCommandOptions& options) {
    std::vector<identify::MappedFile> mapped;
    if (!options.map.empty()) mapped = identify::read_mapped_files(options.map);
    std::vector<ToldFile> files;
    for (const fs::path& file : options.files) {
        const std::size_t before = files.size();
        for (const identify::MappedFile& entry : mapped) {
            if (fs::is_directory(file)) {
                const bool is_series = entry.how.series || entry.file.find('*') != std::string::npos;
                if (is_series || fs::exists(file / entry.file)) files.push_back({file / entry.file, entry.how});
            } else if (identify::names_file(entry, file.filename().string())) {
                files.push_back({file, entry.how});
                files.back().how.series = false;  // this frame of it
            }
        }
        if (files.size() == before) files.push_back({file, {}});
    }
    for (ToldFile& told : files)
        if (!options.unit.empty()) told.how.unit = options.unit;
    return files;
}

/// What is in the files, and a map of them, unless there is one.
Outcome describe_files(const ImportCommandOptions& options, const Common& common) {
    if (!options.output.empty()) refuse_to_overwrite(options.output, common.force);
    Outcome outcome;
    std::string entries;
    outcome.json = {{"recordings", nlohmann::json::array()}};
    for (const auto& [file, how] : told_files(options)) {
        std::vector<identify::Recording> recordings;
        try {
            recordings = identify::read_recordings(file, how);
        } catch (const InvalidInput& error) {
            // a map to start from is the answer to a file that is not understood
            outcome.text += fmt::format("{}\n", error.what());
            outcome.code = bad_input;
        }
        for (const auto& recording : recordings) {
            outcome.text += identify::describe(recording);
            nlohmann::json points = nlohmann::json::array(), channels = nlohmann::json::array();
            for (const auto& point : recording.points) points.push_back(point.name);
            for (const auto& channel : recording.channels)
                channels.push_back({{"name", channel.name}, {"unit", channel.unit}});
            outcome.json["recordings"].push_back({{"source", recording.source},
                                                  {"format", recording.format},
                                                  {"frames", recording.times.size()},
                                                  {"has_clock", recording.has_clock},
                                                  {"points", points},
                                                  {"channels", channels},
                                                  {"events", recording.events.size()},
                                                  {"notes", recording.notes}});
        }
        std::string entry = identify::draft_map(file, recordings, how);
        const std::string head = "files:\n";
        entries += entry.starts_with(head) ? entry.substr(head.size()) : entry;
    }
    const std::string map = std::string(map_head) + "files:\n" + entries + map_tail;
    outcome.json["map"] = map;
    if (options.output.empty()) {
        if (options.map.empty()) outcome.text += "\nA map to edit (-o map.yaml writes it):\n\n" + map;
    } else {
        mesh::write_text(options.output, map);
        outcome.text += fmt::format("Written: {}. Edit it, then palpate import {} --map {} -o SET\n",
                                    options.output.string(), options.files.front().string(), options.output.string());
    }
    return outcome;
}

/// map.yaml beside the first file, or in the first folder. @throws InvalidInput where there is none; before that what
/// speaks against the file, whatever a map says.
fs::path map_beside(const fs::path& file) {
    const fs::path map = (fs::is_directory(file) ? file : file.parent_path()) / "map.yaml";
    if (fs::exists(map)) return map;
    if (fs::is_regular_file(file)) identify::read_recordings(file);
    throw InvalidInput(
        fmt::format("{}: no map says what this is of. 'palpate import {} --describe -o map.yaml' writes "
                    "one to edit; name it with --map.",
                    file.string(), file.string()));
}

nlohmann::json report_json(const identify::ImportReport& report) {
    nlohmann::json json = {{"format", "palpate-import/1"},
                           {"probes", nlohmann::json::array()},
                           {"clocks", nlohmann::json::array()},
                           {"registered_by", report.registered_by},
                           {"registration", nullptr},
                           {"markers", report.markers},
                           {"notes", report.notes}};
    for (const auto& probe : report.probes)
        json["probes"].push_back({{"probe", probe.probe},
                                  {"files", probe.files},
                                  {"seconds", probe.seconds},
                                  {"points", probe.points},
                                  {"channels", probe.channels},
                                  {"states", probe.states}});
    for (const auto& clock : report.clocks)
        json["clocks"].push_back({{"probe", clock.probe},
                                  {"file", clock.file},
                                  {"how", clock.how},
                                  {"offset_s", clock.offset},
                                  {"rate", clock.rate},
                                  {"sd_s", clock.sd}});
    if (report.registration) {
        const auto& fit = *report.registration;
        nlohmann::json rows = nlohmann::json::array();
        for (int i = 0; i < 3; ++i) rows.push_back({fit.motion.R(i, 0), fit.motion.R(i, 1), fit.motion.R(i, 2)});
        json["registration"] = {{"rotation", rows},
                                {"translation_mm", {fit.motion.t.x(), fit.motion.t.y(), fit.motion.t.z()}},
                                {"scale", fit.motion.scale},
                                {"points", fit.points},
                                {"rms_mm", fit.rms},
                                {"max_mm", std::max(fit.largest, fit.rms)},
                                {"rotation_sd_rad", fit.rotation_sd},
                                {"translation_sd_mm", fit.translation_sd},
                                {"notes", fit.notes}};
    }
    return json;
}

/// The set has to be one that the house's own reader takes; nothing is written where it is not.
void check_readable(const fs::path& folder, const fs::path& map) {
    try {
        identify::read_measurement_set(folder);
    } catch (const InvalidInput& error) {
        throw InvalidInput(
            fmt::format("{}: the set that comes of it would not be taken: {}", map.string(), error.what()));
    }
}

}  // namespace

Outcome import(const ImportCommandOptions& options, const Common& common) {
    if (options.describe) return describe_files(options, common);
    if (options.output.empty())
        throw InvalidInput("name the set with -o SET, or give --describe to list what is in the files");
    refuse_to_overwrite(options.output, common.force);
    const identify::ImportOptions how{.map = options.map.empty() ? map_beside(options.files.front()) : options.map,
                                      .files = options.files,
                                      .mesh = options.mesh,
                                      .states = options.states,
                                      .registration = options.registration,
                                      .unit = options.unit};
    const identify::ImportedSet imported = identify::import_set(how);
    Outcome outcome;
    outcome.json = report_json(imported.report);
    outcome.json["set"] = options.output.string();
    outcome.json["states"] = imported.set.states.size();
    identify::write_measurement_set(options.output, imported.set, [&](const fs::path& folder) {
        check_readable(folder, how.map);
        mesh::write_text(folder / "import.json", outcome.json.dump(2) + "\n");
    });
    outcome.text = identify::describe(imported.report);
    outcome.text +=
        fmt::format("{0}: {1}, {2}.\nNext: palpate check {0}\n", options.output.string(),
                    number_of(imported.set.states.size(), "state"), number_of(imported.set.markers.size(), "marker"));
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_import(CLI::App& app) {
    auto* sub =
        subcommand(app, "import", "A measurement set out of a rig's own files.",
                   "  palpate import run.c3d --describe                     # what is in it\n"
                   "  palpate import run.c3d load.csv --describe -o map.yaml    # a map to edit\n"
                   "  palpate import run.csv --describe --map map.yaml      # the same, in the units that a map tells\n"
                   "  palpate import run.c3d load.csv --map map.yaml -o set     # points, forces and the mesh "
                   "in one frame, on one "
                   "clock\n"
                   "  palpate import recordings/ --map map.yaml --states every=0.5s --register icp -o set\n",
                   [this] { return commands::import(importing, common); });
    sub->add_option(
           "FILE", importing.files,
           "What the rig wrote, or folders of it: C3D, TRC, Motive, Vicon, testing machines, image correlation, "
           "scans, tables")
        ->required();
    sub->add_option("-o,--output", importing.output, "The set (a folder); with --describe a map to edit");
    sub->add_option("--map", importing.map,
                    "What the files cannot say: mesh, supports, what each channel is; map.yaml beside them by default")
        ->type_name("PATH");
    sub->add_flag("--describe", importing.describe, "What is in the files, and a map to edit");
    sub->add_option("--mesh", importing.mesh, "The body at rest, in place of the map's")->type_name("PATH");
    sub->add_option("--states", importing.states, "plateaus, every=0.1s or all, in place of the map's");
    sub->add_option(
        "--register", importing.registration,
        "How frames are registered, in place of the map's: auto, fiducials, icp, none, or a file of name,x,y,z");
    sub->add_option("--unit", importing.unit, "Unit of the files' positions, in place of what they say")
        ->check(CLI::IsMember({"mm", "cm", "m", "um", "in"}));
}

}  // namespace palpate::pipeline
