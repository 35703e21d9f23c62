#include "pipeline/output/json/comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "identify/numerics/summaries.h"
#include "pipeline/output/actuator_unit.h"
#include "pipeline/output/damping.h"
#include "pipeline/output/json/json_values.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// Where the first contact of a state presses; null where nothing does.
json pressed_at(const identify::MeasurementSet& set, int probe, double time) {
    const identify::LoadState* state = identify::find_state(set, {probe, time});
    if (!state) return nullptr;
    for (const mesh::Contact& contact : state->contacts)
        if (!contact.force.isZero(0)) return numbers(contact.point);
    return nullptr;
}

/// What moves or drives the body in a state, besides forces: "pad by 3.2 mm, t1 at 6 N"; null where nothing does.
json driven_by(const identify::MeasurementSet& set, int probe, double time) {
    const identify::LoadState* state = identify::find_state(set, {probe, time});
    if (!state) return nullptr;
    std::vector<std::string> drives;
    for (const mesh::ToolMotion& motion : state->motions) {
        const double moved = identify::known_part(motion.translation).norm();
        drives.push_back(fmt::format("{} by {:.3g} mm", set.tools[motion.tool].name, moved));
    }
    for (const identify::Actuation& one : state->actuations) {
        if (one.value == 0) continue;
        const mesh::Actuator& actuator = set.actuators[one.actuator];
        drives.push_back(fmt::format("{} at {:.3g} {}", actuator.name, one.value, unit_of(actuator)));
    }
    return drives.empty() ? json() : json(fmt::format("{}", fmt::join(drives, ", ")));
}

/// How much acts in a state: the sum of its forces [N], how far tools are moved [mm], or what actuators are set to
/// [their unit]; null where such things act together.
json load_of(const identify::MeasurementSet& set, int probe, double time) {
    const identify::LoadState* state = identify::find_state(set, {probe, time});
    if (!state) return nullptr;
    std::map<std::pair<std::string, std::string>, double> loads;  // (by what, unit): how much
    const auto add = [&](const char* by, const char* unit, double amount) {
        if (amount > 0) loads[{by, unit}] += amount;
    };
    for (const mesh::Contact& contact : state->contacts) add("forces", "N", contact.force.norm());
    for (const mesh::ToolMotion& motion : state->motions)
        add("tools", "mm", identify::known_part(motion.translation).norm());
    for (const identify::Actuation& one : state->actuations)
        add("actuators", unit_of(set.actuators[one.actuator]), std::abs(one.value));
    if (loads.empty()) return {{"by", "nothing"}, {"value", 0.0}, {"unit", nullptr}};
    if (loads.size() > 1) return nullptr;
    const auto& [kind, amount] = *loads.begin();
    return {{"by", kind.first}, {"value", amount}, {"unit", kind.second}};
}

/// Rms error of each marker over all states, with its place at rest.
json marker_errors(const identify::Comparison& c, const identify::MeasurementSet& set) {
    std::vector<double> squares(set.markers.size(), 0.0);
    std::vector<int> counts(set.markers.size(), 0);
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const auto& readings = set.states[s].readings;
        for (std::size_t r = 0; r < readings.size(); ++r) {
            if (readings[r].marker < 0) continue;
            const Vec3 error = readings[r].position - c.predicted[s].row(static_cast<Eigen::Index>(r)).transpose();
            for (const double e : error) {
                if (std::isnan(e)) continue;
                squares[readings[r].marker] += e * e;
                ++counts[readings[r].marker];
            }
        }
    }
    json markers = json::array();
    for (std::size_t m = 0; m < set.markers.size(); ++m) {
        if (counts[m] == 0) continue;
        markers.push_back({{"marker", set.markers[m].id},
                           {"rms_mm", std::sqrt(squares[m] / counts[m])},
                           {"at", numbers(set.markers[m].rest)}});
        if (!set.markers[m].name.empty()) markers.back()["name"] = set.markers[m].name;
    }
    return markers;
}

/// The force of each tool in each state, as it was measured and as it is modelled, and where the tool's origin was.
json tool_forces(const identify::ReactionError& reactions, const identify::MeasurementSet& set) {
    json result = json::array();
    for (const identify::ToolForce& force : reactions.forces) {
        const mesh::Tool& tool = set.tools[static_cast<std::size_t>(force.tool)];
        Vec3 at = tool.origin;
        if (const identify::LoadState* state = identify::find_state(set, {force.probe, force.time})) {
            for (const mesh::ToolMotion& motion : state->motions)
                if (motion.tool == force.tool) at += identify::known_part(motion.translation);
        }
        json measured = json::array();
        for (const double component : force.measured) measured.push_back(known(component));
        result.push_back({{"probe", force.probe},
                          {"time", force.time},
                          {"tool", tool.name},
                          {"measured_n", measured},
                          {"modelled_n", numbers(force.modelled)},
                          {"error_n", force.error()},
                          {"at", numbers(at)}});
    }
    return result;
}

}  // namespace

json to_json(const identify::Comparison& c, const identify::MeasurementSet& set) {
    json result = {
        {"format", "palpate-comparison/1"},
        {"error",
         {{"rms_mm", c.rms}, {"max_mm", c.max}, {"relative", known(c.relative)}, {"noise_mm", known(c.noise)}}},
        {"adequate", c.adequate},
        {"p_value", known(c.p_value)}};
    if (c.reactions) {
        result["error"]["reactions"] = {
            {"rms_n", c.reactions->rms}, {"max_n", c.reactions->max}, {"relative", known(c.reactions->relative)}};
        result["tool_forces"] = tool_forces(*c.reactions, set);
    }
    if (c.load_exponent) {
        result["load_exponent"] = {
            {"value", c.load_exponent->value}, {"sd", c.load_exponent->sd}, {"words", c.load_exponent->words}};
    }
    if (!c.overloaded_probes.empty()) result["not_borne"] = c.overloaded_probes;
    result["probes"] = json::array();
    for (const auto& p : c.probes) {
        result["probes"].push_back({{"probe", p.probe},
                                    {"time", p.time},
                                    {"rms_mm", p.rms},
                                    {"max_mm", p.max},
                                    {"relative", known(p.relative)},
                                    {"load", load_of(set, p.probe, p.time)},
                                    {"at", pressed_at(set, p.probe, p.time)},
                                    {"driven_by", driven_by(set, p.probe, p.time)}});
    }
    result["worst"] = json::array();
    for (const auto& w : c.worst) {
        result["worst"].push_back({{"marker", w.marker},
                                   {"probe", w.probe},
                                   {"time", w.time},
                                   {"error_mm", w.error},
                                   {"at", numbers(w.at)},
                                   {"towards", numbers(w.towards)}});
    }
    result["markers"] = marker_errors(c, set);
    const mesh::Box box = mesh::bounding_box(set.rest_surface.vertices);
    result["box"] = {{"min", numbers(box.min)}, {"max", numbers(box.max)}};
    return result;
}

json worst_probes_json(const identify::Comparison& comparison, const identify::MeasurementSet& set) {
    constexpr std::size_t listed_probes = 3;  // enough to see whether one stands out
    std::vector<identify::ProbeError> worst;
    std::ranges::copy_if(comparison.probes, std::back_inserter(worst),
                         [](const identify::ProbeError& p) { return std::isfinite(p.relative); });
    std::ranges::stable_sort(worst, std::greater{}, &identify::ProbeError::relative);
    const Points& surface = set.rest_surface.vertices;
    const std::vector<char> held = mesh::contains(set.supports, surface);
    json result = json::array();
    for (const identify::ProbeError& probe : worst) {
        if (result.size() == listed_probes) break;
        const auto state = std::ranges::find_if(set.states, [&](const identify::LoadState& s) {
            return s.probe == probe.probe && s.time == probe.time && !s.contacts.empty();
        });
        if (state == set.states.end()) continue;
        const Vec3 at = state->contacts.front().point;
        double gap = INFINITY;
        for (Eigen::Index v = 0; v < surface.rows(); ++v)
            if (held[static_cast<std::size_t>(v)]) gap = std::min(gap, (surface.row(v).transpose() - at).norm());
        result.push_back({{"probe", probe.probe},
                          {"relative", probe.relative},
                          {"at", numbers(at)},
                          {"from_support_mm", known(gap)}});
    }
    return result;
}

json to_json(const mesh::SurfaceReport& r) {
    return {{"vertices", r.vertices},
            {"triangles", r.triangles},
            {"duplicate_vertices", r.duplicate_vertices},
            {"degenerate_triangles", r.degenerate_triangles},
            {"duplicate_triangles", r.duplicate_triangles},
            {"boundary_edges", r.boundary_edges},
            {"holes", r.holes},
            {"non_manifold_edges", r.non_manifold_edges},
            {"inconsistent_edges", r.inconsistent_edges},
            {"self_intersections", r.self_intersections},
            {"components", r.components},
            {"closed", r.closed},
            {"outward", r.outward},
            {"volume_mm3", r.volume},
            {"area_mm2", r.area},
            {"box", {{"min", numbers(r.box.min)}, {"max", numbers(r.box.max)}}},
            {"sound", r.sound()}};
}

json summary_json(const identify::IdentifyResult& result) {
    json posterior = json::array();
    int informed = 0;
    for (const auto& row : result.posterior) informed += row.informed ? 1 : 0;
    constexpr std::size_t most_listed = 30;  // the rest stands in posterior.csv
    if (result.posterior.size() <= most_listed) {
        for (std::size_t p = 0; p < result.posterior.size(); ++p) {
            const identify::PosteriorRow& row = result.posterior[p];
            posterior.push_back({{"parameter", row.parameter},
                                 {"unit", row.unit},
                                 {"best", result.best[static_cast<Eigen::Index>(p)]},
                                 {"mean", row.mean},
                                 {"sd", row.sd},
                                 {"q025", row.q025},
                                 {"q975", row.q975}});
        }
    }
    json modes = json::array();
    for (const identify::Mode& mode : result.modes) {
        json entry = {{"probability", mode.probability}};
        if (result.posterior.size() <= most_listed) {
            for (std::size_t p = 0; p < result.posterior.size(); ++p) {
                entry["stiffness"][result.posterior[p].parameter] = mode.stiffness[static_cast<Eigen::Index>(p)];
            }
        }
        modes.push_back(std::move(entry));
    }
    json places = json::array();
    for (const Vec3& place : result.measured.places) places.push_back({place.x(), place.y(), place.z()});
    return {{"law", skeleton::law_names[static_cast<std::size_t>(result.model.law)]},
            {"parameters", result.posterior.size()},
            {"informed", informed},
            {"posterior", posterior},
            {"modes", modes},
            {"log_evidence", known(result.log_evidence)},
            {"log_evidence_sd", known(result.log_evidence_sd)},
            {"r_hat", known(result.r_hat)},
            {"effective_samples", result.history.empty() ? 0.0 : result.history.back().effective_samples},
            {"acceptance", known(result.acceptance)},
            {"model_error", known(result.model_error)},
            {"forecast_error",
             {{"relative", known(result.forecast_error.relative)},
              {"least_displacement_mm", result.forecast_error.least_displacement},
              {"probes", result.forecast_error.probes}}},
            {"measured",
             {{"force_N", result.measured.force},
              {"displacement_mm", result.measured.displacement},
              {"places_mm", places}}},
            {"equilibria", result.equilibria},
            {"damping", result.damping ? to_json(*result.damping) : json(nullptr)},
            {"notes", result.notes}};
}

}  // namespace palpate::pipeline
