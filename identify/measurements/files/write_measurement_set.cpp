#include <fmt/format.h>

#include <cmath>
#include <string>

#include "identify/measurements/files/probes_table.h"
#include "identify/measurements/files/rig/regions_yaml.h"
#include "identify/measurements/files/rig/rig_yaml.h"
#include "identify/measurements/files/rig/write_rig_tables.h"
#include "identify/measurements/files/second_format.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/supports/region_yaml.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/unfinished.h"
#include "mesh/text/words.h"

namespace palpate::identify {

namespace fs = std::filesystem;

namespace {

/// The shortest number of kg/m^3 that is read back as this density.
std::string density_text(double density) {
    double shown = density * 1e12;
    for (int digits = 1; digits <= 17; ++digits) {
        shown = mesh::parse_number(fmt::format("{:.{}g}", density * 1e12, digits)).value();
        if (shown / 1e12 == density) break;
    }
    return fmt::format("{}", shown);
}

const char* rest_file(const MeasurementSet& set) { return set.rest_volume ? "rest.vtu" : "rest.vtp"; }

std::string noise_to_yaml(const MeasurementSet& set) {
    std::string text;
    const auto add = [&](const char* of, const std::optional<double>& sigma) {
        if (sigma) text += fmt::format("  {}: {}\n", of, *sigma);
    };
    add("position", set.position_noise);
    add("force", set.force_noise);
    add("reaction", set.reaction_noise);
    add("moment", set.moment_noise);
    if (!text.empty()) text = "noise:  # 1 sigma\n" + text;
    if (set.position_correlation) text += fmt::format("correlated: {{position: {}}}\n", *set.position_correlation);
    return text;
}

/// Of a set that is written into `folder`.
std::string description(const MeasurementSet& set, const fs::path& folder) {
    const bool is_second = needs_second_format(set);
    std::string text = fmt::format(
        "format: {}\n"
        "name: {}\n"
        "units: {{length: mm, force: N, time: s{}}}\n"
        "rest_surface: {}\n"
        "supports:\n{}",
        is_second ? second_format_name : first_format_name, yaml_text(set.name),
        is_second ? ", angle: rad, pressure: MPa, moment: N*mm" : "", rest_file(set),
        mesh::regions_to_yaml_in(folder, set.supports));
    text += tools_to_yaml(folder, set.tools) + actuators_to_yaml(folder, set.actuators);
    text += regions_to_yaml(folder, set.regions);
    if (const auto since = displacements_since(set))
        text += fmt::format("displacements: {{since: {{probe: {}, time: {}}}}}\n", since->probe, since->time);
    if (set.density) text += fmt::format("density: {}  # kg/m^3\n", density_text(*set.density));
    text += fmt::format("history: {}\n", set.continuous ? "continuous" : "fresh");
    if (set.gravity) text += fmt::format("gravity: [{}]  # mm/s^2\n", fmt::join(*set.gravity, ", "));
    text += noise_to_yaml(set);
    if (set.material && !(std::isnan(set.material->young) && std::isnan(set.material->poisson))) {
        text += "material:  # first guess\n";
        if (!std::isnan(set.material->young)) text += fmt::format("  young: {}  # MPa\n", set.material->young);
        if (!std::isnan(set.material->poisson)) text += fmt::format("  poisson: {}\n", set.material->poisson);
    }
    return text;
}

std::string markers_table(const MeasurementSet& set) {
    std::string text = "marker,x,y,z,ax,ay,az\n";
    for (const Marker& marker : set.markers)
        text += fmt::format("{},{},{}\n", table_name(label_of(marker)), table_cells(marker.rest),
                            table_cells(marker.anchor.value_or(Vec3::Constant(missing))));
    return text;
}

constexpr const char* positions_header = "probe,time,marker,x,y,z,sigma\n";

std::string position_rows(const MeasurementSet& set, int probe, double time, const std::vector<Reading>& readings) {
    std::string text;
    for (const Reading& reading : readings) {
        if (reading.since) continue;  // of displacements.csv
        const auto marker = static_cast<std::size_t>(reading.marker);
        text += fmt::format("{},{},{},{},{}\n", probe, time,
                            reading.marker < 0 ? "" : table_name(label_of(set.markers.at(marker))),
                            table_cells(reading.position), table_cell(reading.sigma));
    }
    return text;
}

std::string positions_table(const MeasurementSet& set) {
    std::string text = positions_header;
    for (const LoadState& state : set.states) text += position_rows(set, state.probe, state.time, state.readings);
    return text;
}

/// motion_probes.csv and motion_positions.csv, where something moved.
void write_recordings(const fs::path& folder, const MeasurementSet& set) {
    if (set.recordings.empty()) return;
    std::vector<LoadState> loads;
    std::string text = positions_header;
    for (const MotionRecording& recording : set.recordings) {
        loads.insert(loads.end(), recording.loads.begin(), recording.loads.end());
        for (const MotionRecording::Instant& instant : recording.instants)
            text += position_rows(set, recording.probe, instant.time, instant.readings);
    }
    mesh::write_text(folder / "motion_probes.csv", probes_table(loads));
    mesh::write_text(folder / "motion_positions.csv", text);
}

/// What is known to act in states, or nothing.
std::string states_table(const MeasurementSet& set) {
    std::string text;
    for (const LoadState& state : set.states)
        if (!state.gravity.array().isNaN().all() || !std::isnan(state.pressure))
            text += fmt::format("{},{},{},{}\n", state.probe, state.time, table_cells(state.gravity),
                                table_cell(state.pressure));
    return text.empty() ? text : "probe,time,gx,gy,gz,pressure\n" + text;
}

/// Puts a finished folder in the place of `target`; an old one goes only when the new one stands.
void move_into_place(const fs::path& finished, const fs::path& target) {
    if (!fs::exists(target)) {
        fs::rename(finished, target);
        return;
    }
    fs::path old = finished;
    old += ".old";
    fs::rename(target, old);
    try {
        fs::rename(finished, target);
    } catch (...) {
        fs::rename(old, target);
        throw;
    }
    fs::remove_all(old);
}

}  // namespace

std::string probes_table(const std::vector<LoadState>& states) {
    std::string text = "probe,time,x,y,z,fx,fy,fz,radius\n";
    for (const LoadState& state : states) {
        for (const mesh::Contact& contact : state.contacts)
            text += fmt::format("{},{},{},{},{}\n", state.probe, state.time, table_cells(contact.point),
                                table_cells(contact.force), contact.radius);
        if (state.contacts.empty()) text += fmt::format("{},{},0,0,0,0,0,0,0\n", state.probe, state.time);
    }
    return text;
}

fs::path field_file(const LoadState& state) {
    return fs::path("field") / fmt::format("{}_{}.vtu", state.probe, state.time);
}

void write_measurement_set(const fs::path& folder, const MeasurementSet& set,
                           const std::function<void(const fs::path&)>& extra) {
    const fs::path target = fs::absolute(folder / "").parent_path();
    const fs::path temporary = mesh::unfinished_beside(target);
    std::error_code ignored;
    try {
        fs::create_directories(temporary);
        if (set.rest_volume)
            mesh::write_vtu(temporary / rest_file(set), *set.rest_volume);
        else
            mesh::write_vtp(temporary / rest_file(set), set.rest_surface);
        mesh::write_text(temporary / "set.yaml", description(set, temporary));
        mesh::write_text(temporary / "probes.csv", probes_table(set.states));
        mesh::write_text(temporary / "markers.csv", markers_table(set));
        mesh::write_text(temporary / "positions.csv", positions_table(set));
        if (const std::string states = states_table(set); !states.empty())
            mesh::write_text(temporary / "states.csv", states);
        write_rig_tables(temporary, set);
        write_recordings(temporary, set);
        if (extra) extra(temporary);
        move_into_place(temporary, target);
    } catch (const fs::filesystem_error& error) {
        fs::remove_all(temporary, ignored);
        throw IoError(fmt::format("{}: cannot be written ({}).", target.string(), error.code().message()));
    } catch (...) {
        fs::remove_all(temporary, ignored);
        throw;
    }
}

}  // namespace palpate::identify
