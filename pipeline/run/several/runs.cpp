#include "pipeline/run/several/runs.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// "skeleton.spheres": "12", for each setting of a case.
void flatten(const YAML::Node& node, const std::string& name, std::map<std::string, std::string>& settings) {
    if (node.IsMap()) {
        for (const auto& entry : node)
            flatten(entry.second, (name.empty() ? "" : name + ".") + entry.first.as<std::string>(), settings);
        return;
    }
    YAML::Emitter text;
    text << YAML::Flow << node;
    settings[name] = text.c_str();
}

/// Where the runs differ; "" where a run has no such setting.
json differing_settings(const std::vector<NamedRun>& runs) {
    std::map<std::string, std::vector<std::string>> values;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        std::map<std::string, std::string> settings;
        flatten(YAML::Load(runs[r].files.settings), "", settings);
        settings["seed"] = runs[r].files.record.value("seed", json()).dump();
        for (const auto& [name, value] : settings) {
            values[name].resize(runs.size());
            values[name][r] = value;
        }
    }
    json differing = json::array();
    for (const auto& [name, of_runs] : values) {
        if (std::ranges::count(of_runs, of_runs.front()) < static_cast<std::ptrdiff_t>(of_runs.size()))
            differing.push_back({{"setting", name}, {"values", of_runs}});
    }
    return differing;
}

/// compare.json of the model to use.
const json& final_comparison(const RunFiles& files) {
    return files.improved.is_object() ? files.improved : files.compare;
}

/// What was done to the body in each state, and where the body lies.
json states_of(const json& compare) {
    json states = json::array();
    for (const json& p : compare["probes"])
        states.push_back({p["probe"], p["time"], p.value("load", json()), p.value("at", json())});
    return {states, compare.value("box", json())};
}

/// The rms of what was measured, out of an error and its share of that; null where the share is not known.
json measured_rms(const json& rms, const json& share) {
    if (!rms.is_number() || !share.is_number() || share.get<double>() <= 0) return nullptr;
    return rms.get<double>() / share.get<double>();
}

/// What the readings of each state come to, whatever the model: other readings are told by it.
json readings_of(const json& compare) {
    json readings = json::array();
    for (const json& p : compare["probes"]) readings.push_back(measured_rms(p["rms_mm"], p["relative"]));
    if (const json forces = compare["error"].value("reactions", json()); forces.is_object())
        readings.push_back(measured_rms(forces["rms_n"], forces["relative"]));
    return readings;
}

bool are_the_same_readings(const json& some, const json& others) {
    constexpr double rounding = 1e-9;  // of a quotient of numbers written in full; other readings differ by far more
    return std::ranges::equal(some, others, [](const json& a, const json& b) {
        if (!a.is_number() || !b.is_number()) return a == b;
        return std::abs(a.get<double>() - b.get<double>()) <= rounding * std::abs(a.get<double>());
    });
}

/// Were forces of tools measured, and no positions?
bool reads_forces_only(const json& compare) {
    return compare["probes"].empty() && compare["error"].contains("reactions");
}

json run_json(const NamedRun& run) {
    const RunFiles& files = run.files;
    const json& now = final_comparison(files);
    double seconds = 0;
    for (const json& stage : files.record["stages"]) seconds += stage["seconds"].get<double>();
    const json material = now.value("baseline", json());
    const json last_step = files.ladder.is_object() ? files.ladder["steps"].back() : json::object();
    json rms_n;
    if (reads_forces_only(files.compare))
        rms_n = {{"nothing_added", files.compare["error"]["reactions"]["rms_n"]},
                 {"now", now["error"]["reactions"]["rms_n"]},
                 {"held_out", last_step.value("held_out_reactions_rms_n", json())}};
    return {{"run", run.name},
            {"verdict", files.diagnosis.is_object() ? files.diagnosis["verdict"] : json()},
            {"effects", added_effects(files)},
            {"rms_mm", {{"nothing_added", files.compare["error"]["rms_mm"]}, {"now", now["error"]["rms_mm"]}}},
            {"rms_n", rms_n},
            {"held_out_rms_mm", last_step.value("held_out_rms_mm", json())},
            {"held_out_probes", files.ladder.is_object() ? files.ladder["held_out_probes"] : json::array()},
            {"relative", now["error"]["relative"]},
            {"noise_mm", now["error"]["noise_mm"]},
            {"material", material.is_object() ? json(material_in_words(material)) : json()},
            {"spheres", files.model.spheres.size()},
            {"links", files.model.links.size()},
            {"stiffnesses", files.posterior.size()},
            {"informed", std::ranges::count_if(files.posterior, [](const auto& row) { return row.informed; })},
            {"seconds", seconds}};
}

/// The error of each state in each run, with what was added.
json errors_by_state(const std::vector<NamedRun>& runs) {
    json rows = json::array();
    const json& states = final_comparison(runs.front().files)["probes"];
    for (std::size_t s = 0; s < states.size(); ++s) {
        json errors = json::array();
        for (const NamedRun& run : runs) errors.push_back(final_comparison(run.files)["probes"][s]["rms_mm"]);
        rows.push_back({{"probe", states[s]["probe"]}, {"time", states[s]["time"]}, {"rms_mm", errors}});
    }
    return rows;
}

}  // namespace

json runs_json(const std::vector<NamedRun>& runs) {
    json all = {{"format", "palpate-runs/1"}, {"runs", json::array()}, {"settings", differing_settings(runs)}};
    bool same_states = true, same_readings = true;
    const json &first = runs.front().files.compare, states = states_of(first), readings = readings_of(first);
    for (const NamedRun& run : runs) {
        all["runs"].push_back(run_json(run));
        same_states =
            same_states && states_of(run.files.compare) == states && states_of(final_comparison(run.files)) == states;
        same_readings = same_readings && are_the_same_readings(readings, readings_of(run.files.compare));
    }
    all["same_states"] = same_states;
    all["same_readings"] = same_readings;
    all["states"] = same_states ? errors_by_state(runs) : json::array();
    return all;
}

}  // namespace palpate::pipeline
