#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "identify/measurements/files/tables.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {

namespace fs = std::filesystem;
using mesh::CsvTable;

namespace {

/// The index of the tool or actuator that a row names. @throws InvalidInput where set.yaml has none of that name.
template <class Named>
int index_of_name(const CsvTable& table, int row, const std::string& column, const std::vector<Named>& all) {
    const std::string& name = table.name(row, column);
    const auto found = std::ranges::find(all, name, &Named::name);
    if (found != all.end()) return static_cast<int>(found - all.begin());
    std::vector<std::string> known;
    std::ranges::transform(all, std::back_inserter(known), &Named::name);
    throw InvalidInput(fmt::format(
        "{}: there is no {} {}{}. {}.", table.where(row), column, mesh::cited(name), mesh::suggestion(name, known),
        known.empty() ? fmt::format("Describe it in set.yaml, under '{}s'", column)
                      : fmt::format("set.yaml describes {}; correct the name, or add it there", mesh::listed(known))));
}

/// @throws InvalidInput where a tool or actuator has a row of this state already.
template <class Rows, class Index>
void check_single_row(const CsvTable& table, int row, const Rows& rows, Index index, int number, const char* column) {
    if (std::ranges::find(rows, number, index) == rows.end()) return;
    const StateName state = state_name(table, row);
    throw InvalidInput(fmt::format("{}: {} {} has a row of probe {} at time {} already. Keep one.", table.where(row),
                                   column, mesh::cited(table.name(row, column)), state.probe, state.time));
}

/// A turn is held at 0 where the table has no such column; free where the cell is empty.
Vec3 read_turn(const CsvTable& table, int row) {
    Vec3 turn = Vec3::Zero();
    const char* const columns[] = {"rx", "ry", "rz"};
    for (int axis = 0; axis < 3; ++axis)
        if (table.has(columns[axis])) turn[axis] = table.at(row, columns[axis]);
    return turn;
}

}  // namespace

void TableReader::read_motions(const fs::path& file) {
    const CsvTable table(file, {"probe", "time", "tool", "x", "y", "z"}, {"rx", "ry", "rz"}, {"tool"});
    require_length(table, {"x", "y", "z"});
    for (int row = 0; row < table.rows(); ++row) {
        check_not_negative(table.number(row, "time"), table.where(row));
        const int tool = index_of_name(table, row, "tool", set_.tools);
        LoadState& moved = state(state_name(table, row), table, row);
        check_single_row(table, row, moved.motions, &mesh::ToolMotion::tool, tool, "tool");
        const mesh::ToolMotion motion{.tool = tool,
                                      .translation = units_.length * vector_if_given(table, row, {"x", "y", "z"}),
                                      .rotation = units_.angle * read_turn(table, row)};
        const bool grips = std::holds_alternative<mesh::GripShape>(set_.tools[static_cast<std::size_t>(tool)].shape);
        if (!grips && motion.translation.array().isNaN().all() && motion.rotation.array().isNaN().all())
            throw InvalidInput(
                fmt::format("{}: all coordinates of tool {} are left free, so nothing keeps it at the body. Tell where "
                            "it was (0 is held), or take the row away where it did not touch.",
                            table.where(row), mesh::cited(table.name(row, "tool"))));
        moved.motions.push_back(motion);
    }
}

void TableReader::read_actuations(const fs::path& file) {
    const CsvTable table(file, {"probe", "time", "actuator", "value"}, {"sigma"}, {"actuator"});
    for (int row = 0; row < table.rows(); ++row) {
        check_not_negative(table.number(row, "time"), table.where(row));
        const int number = index_of_name(table, row, "actuator", set_.actuators);
        LoadState& actuated = state(state_name(table, row), table, row);
        check_single_row(table, row, actuated.actuations, &Actuation::actuator, number, "actuator");
        const auto* tendon = std::get_if<mesh::TendonActuator>(&set_.actuators[static_cast<std::size_t>(number)].kind);
        const double unit = !tendon ? units_.pressure : tendon->by_length ? units_.length : units_.force;
        const double value = table.number(row, "value");
        if (tendon && !tendon->by_length && value < 0)
            throw InvalidInput(
                fmt::format("{}, column value: a tension of {} would push, and a tendon pulls. Give it without its "
                            "sign, or 0 where it is slack.",
                            table.where(row), value));
        constexpr double least = 1e-15;  // [unit]: whatever is less is a slip
        actuated.actuations.push_back({number, unit * value, unit * told_sigma(table, row, least)});
    }
}

void TableReader::order_states() {
    if (beyond_.empty() && first_table_ == "probes.csv") return;  // as its rows stand
    if (set_.continuous) {
        if (!beyond_.empty())
            throw InvalidInput(
                fmt::format("{}: {} has no row of this state, so the order in which one body went through all of them "
                            "('history: continuous') is not told. List every state in probes.csv, in order, with zero "
                            "force where nothing pressed.",
                            beyond_, first_table_));
        for (const LoadState& one : set_.states)
            check_time({one.probe, one.time},
                       fmt::format("{}: probe {} at time {}", first_table_, one.probe, one.time));
        return;
    }
    std::map<int, std::size_t> rank;  // of each probe, by its first state
    for (const LoadState& one : set_.states) rank.try_emplace(one.probe, rank.size());
    std::ranges::stable_sort(set_.states, {},
                             [&](const LoadState& one) { return std::pair(rank.at(one.probe), one.time); });
    for (std::size_t s = 0; s < set_.states.size(); ++s) index_of_[{set_.states[s].probe, set_.states[s].time}] = s;
}

void TableReader::read_displacements(const fs::path& file, const std::optional<StateName>& since) {
    if (since && !index_of_.contains(*since))
        throw InvalidInput(
            fmt::format("{}: they count from probe {} at time {} ('displacements.since' in set.yaml), and there is no "
                        "such state. Add its row to probes.csv (with zero force when nothing pressed), or correct the "
                        "numbers.",
                        file.string(), since->probe, since->time));
    const CsvTable table(file, {"probe", "time", "marker", "ux", "uy", "uz"}, {"sigma"}, {"marker"});
    require_length(table, {"ux", "uy", "uz", "sigma"});
    std::set<std::pair<std::size_t, int>> seen;  // of differences; those from rest are positions
    int of_reference = 0;
    for (int row = 0; row < table.rows(); ++row) {
        const std::size_t number = known_state(table, row);
        const int marker = marker_of_row(table, row);
        if (marker < 0)
            throw InvalidInput(fmt::format(
                "{}: a displacement has no marker, so nobody knows from where. Give its number.", table.where(row)));
        if (!since) {
            check_single(number, marker, table.where(row));
        } else if (!seen.emplace(number, marker).second) {
            throw InvalidInput(fmt::format("{}: marker {} has a displacement of this state already. Keep one.",
                                           table.where(row), table.text(row, "marker")));
        }
        const double sigma = position_sigma(table, row);
        const Vec3 u = units_.length * vector_if_given(table, row, {"ux", "uy", "uz"});
        if (u.array().isNaN().all()) continue;  // nothing was seen
        LoadState& measured = set_.states[number];
        if (since && *since == StateName{measured.probe, measured.time}) {
            if (!(u.array().isNaN() || u.array() == 0).all())
                throw InvalidInput(
                    fmt::format("{}: marker {} has moved by [{:.4g}] since this very state. Name the state that was "
                                "the reference under 'displacements.since' in set.yaml.",
                                table.where(row), table.text(row, "marker"), fmt::join(u, ", ")));
            ++of_reference;
            continue;
        }
        const Vec3 rest = set_.markers[static_cast<std::size_t>(marker)].rest;
        measured.readings.push_back({.marker = marker, .position = rest + u, .sigma = sigma, .since = since});
    }
    if (of_reference > 0)
        set_.notes.push_back(
            fmt::format("{} displacements of the state that all count from are 0 and tell nothing: they are left out.",
                        of_reference));
}

void TableReader::read_reactions(const fs::path& file) {
    const CsvTable table(file, {"probe", "time", "tool", "fx", "fy", "fz"}, {"mx", "my", "mz", "sigma"}, {"tool"});
    table.require_unit({"fx", "fy", "fz", "sigma"}, units_.force_name, "set.yaml");
    for (int row = 0; row < table.rows(); ++row) {
        LoadState& measured = set_.states[known_state(table, row)];
        const int tool = index_of_name(table, row, "tool", set_.tools);
        check_single_row(table, row, measured.reactions, &ReactionReading::tool, tool, "tool");
        if (std::ranges::find(measured.motions, tool, &mesh::ToolMotion::tool) == measured.motions.end())
            throw InvalidInput(
                fmt::format("{}: tool {} is away in probe {} at time {}, as motions.csv has no row of it there, and "
                            "what is away exerts no force. Tell in motions.csv where it was, or take the reading away.",
                            table.where(row), mesh::cited(table.name(row, "tool")), measured.probe, measured.time));
        const ReactionReading reading{.tool = tool,
                                      .force = units_.force * vector_if_given(table, row, {"fx", "fy", "fz"}),
                                      .moment = units_.moment * vector_if_given(table, row, {"mx", "my", "mz"}),
                                      .sigma = units_.force * told_sigma(table, row, least_force_noise / units_.force)};
        const bool reads_force = !reading.force.array().isNaN().all();
        if (!reads_force && reading.moment.array().isNaN().all()) continue;  // nothing was read
        if (!reads_force && !std::isnan(reading.sigma))
            throw InvalidInput(
                fmt::format("{}, column sigma: it is that of a force, and this row reads moments only. Tell their "
                            "noise by 'noise.moment' in set.yaml.",
                            table.where(row)));
        measured.reactions.push_back(reading);
    }
}

}  // namespace palpate::identify
