#include "identify/measurements/files/rig/write_rig_tables.h"

#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::identify {
namespace {

/// The lines that `row` makes of each state, under their header; "" without any.
template <class Row>
std::string table_of(const MeasurementSet& set, const char* header, Row row) {
    std::string text;
    for (const LoadState& state : set.states) text += row(state, fmt::format("{},{}", state.probe, state.time));
    return text.empty() ? text : header + text;
}

std::string motions_table(const MeasurementSet& set) {
    return table_of(set, "probe,time,tool,x,y,z,rx,ry,rz\n", [&](const LoadState& state, const std::string& name) {
        std::string rows;
        for (const mesh::ToolMotion& motion : state.motions)
            rows += fmt::format("{},{},{},{}\n", name, set.tools.at(static_cast<std::size_t>(motion.tool)).name,
                                table_cells(motion.translation), table_cells(motion.rotation));
        return rows;
    });
}

std::string reactions_table(const MeasurementSet& set) {
    return table_of(
        set, "probe,time,tool,fx,fy,fz,mx,my,mz,sigma\n", [&](const LoadState& state, const std::string& name) {
            std::string rows;
            for (const ReactionReading& reading : state.reactions)
                rows += fmt::format("{},{},{},{},{}\n", name, set.tools.at(static_cast<std::size_t>(reading.tool)).name,
                                    table_cells(reading.force), table_cells(reading.moment), table_cell(reading.sigma));
            return rows;
        });
}

std::string actuations_table(const MeasurementSet& set) {
    return table_of(set, "probe,time,actuator,value,sigma\n", [&](const LoadState& state, const std::string& name) {
        std::string rows;
        for (const Actuation& actuation : state.actuations)
            rows +=
                fmt::format("{},{},{},{}\n", name, set.actuators.at(static_cast<std::size_t>(actuation.actuator)).name,
                            actuation.value, table_cell(actuation.sigma));
        return rows;
    });
}

std::string displacements_table(const MeasurementSet& set) {
    return table_of(set, "probe,time,marker,ux,uy,uz,sigma\n", [&](const LoadState& state, const std::string& name) {
        std::string rows;
        for (const Reading& reading : state.readings) {
            if (!reading.since) continue;
            const Marker& marker = set.markers.at(static_cast<std::size_t>(reading.marker));
            rows += fmt::format("{},{},{},{}\n", name, table_name(label_of(marker)),
                                table_cells(reading.position - marker.rest), table_cell(reading.sigma));
        }
        return rows;
    });
}

}  // namespace

std::string table_cell(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string table_cells(const Vec3& v) {
    return fmt::format("{},{},{}", table_cell(v.x()), table_cell(v.y()), table_cell(v.z()));
}

std::string table_name(const std::string& name) {
    return name.find_first_of(",;#\t") == std::string::npos ? name : '"' + name + '"';
}

std::optional<StateName> displacements_since(const MeasurementSet& set) {
    std::optional<StateName> since;
    for (const LoadState& state : set.states)
        for (const Reading& reading : state.readings) {
            if (!reading.since) continue;
            if (since && *since != *reading.since)
                throw InvalidInput(
                    fmt::format("set '{}': its displacements count from probe {} at time {} and from probe {} at time "
                                "{}, and displacements.csv has one such state. Write a set for each.",
                                set.name, since->probe, since->time, reading.since->probe, reading.since->time));
            since = reading.since;
        }
    return since;
}

void write_rig_tables(const std::filesystem::path& folder, const MeasurementSet& set) {
    const auto write = [&](const char* file, const std::string& text) {
        if (!text.empty()) mesh::write_text(folder / file, text);
    };
    write("motions.csv", motions_table(set));
    write("reactions.csv", reactions_table(set));
    write("actuations.csv", actuations_table(set));
    write("displacements.csv", displacements_table(set));
}

}  // namespace palpate::identify
