#include "pipeline/synthesis/loading/probe_load_history.h"

#include "identify/loading/creep.h"
#include "identify/loading/history/lagged_load.h"

namespace palpate::pipeline {

identify::LoadState ProbeLoadHistory::state(std::size_t row) const {
    identify::LoadState state{.probe = probe, .time = rows[row].time};
    if (drive.drives()) {
        state.motions = motions(rows[row].force);
        for (const mesh::ActuatorSetting& one : settings(rows[row].force))
            state.actuations.push_back({one.actuator, one.value});
    } else if (rows[row].force != 0) {
        state.contacts = {contact};
        state.contacts.front().force *= rows[row].force;
    }
    return state;
}

std::vector<mesh::ToolMotion> ProbeLoadHistory::motions(double amount) const {
    if (drive.tool < 0 || amount == 0) return {};
    return {{.tool = drive.tool, .translation = drive.from + amount * drive.along}};
}

std::vector<mesh::ActuatorSetting> ProbeLoadHistory::settings(double amount) const {
    if (drive.actuator < 0 || amount == 0) return {};
    return {{drive.actuator, amount}};
}

std::vector<double> ProbeLoadHistory::times_until(std::size_t row) const {
    std::vector<double> times;
    times.reserve(row + 1);
    for (std::size_t j = 0; j <= row; ++j) times.push_back(rows[j].time);
    return times;
}

double ProbeLoadHistory::effective_force(std::size_t row, const std::optional<fem::CreepLaw>& creep) const {
    if (!creep) return rows[row].force;
    const std::vector<double> weights = identify::superposition_weights(times_until(row), *creep);
    double force = 0;
    for (std::size_t j = 0; j <= row; ++j) force += weights[j] * rows[j].force;
    return force;
}

double ProbeLoadHistory::lagged_force(std::size_t row, double lag, const std::optional<fem::CreepLaw>& creep) const {
    if (lag == 0) return effective_force(row, creep);
    const identify::InstantBetween at = identify::place_among(times_until(rows.size() - 1), rows[row].time - lag);
    const double before = at.before < 0 ? 0 : effective_force(static_cast<std::size_t>(at.before), creep);
    return (1 - at.share) * before + at.share * effective_force(static_cast<std::size_t>(at.after), creep);
}

ProbeLoadHistory unloaded_history() { return {.probe = 0, .contact = {}, .rows = {{}}}; }

std::vector<Row> rows_of(const std::vector<double>& forces, const LoadTiming& timing) {
    const std::vector<double> dwell = timing.dwell.empty() ? std::vector<double>{1} : timing.dwell;
    std::vector<Row> rows;
    std::vector<double> all = forces;
    if (timing.back && !forces.empty()) all.insert(all.end(), forces.rbegin() + 1, forces.rend());
    double begin = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double force = all[i];
        for (const double time : dwell) rows.push_back({begin + time, force});
        begin += dwell.back();
        const bool is_last = i + 1 == all.size();
        if (!timing.unload && !(timing.back && is_last)) continue;
        begin += dwell.front();
        rows.push_back({begin, 0});
    }
    return rows;
}

std::vector<double> levels_of(int probe, int levels) {
    constexpr int in_turn = 3;
    if (levels == 0) return {(1 + probe % in_turn) / static_cast<double>(in_turn)};
    std::vector<double> all;
    all.reserve(static_cast<std::size_t>(levels));
    for (int k = 1; k <= levels; ++k) all.push_back(static_cast<double>(k) / levels);
    return all;
}

}  // namespace palpate::pipeline
