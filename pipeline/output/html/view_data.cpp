#include "pipeline/output/html/view_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/poly_data.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "pipeline/analysis/link_uncertainty.h"
#include "pipeline/case/json_file.h"
#include "pipeline/output/findings.h"
#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/packed_rows.h"
#include "pipeline/output/html/run_files.h"
#include "pipeline/output/html/view_tools.h"
#include "pipeline/output/json/json_values.h"
#include "pipeline/output/text/words.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json floats(const Eigen::MatrixXd& matrix) { return packed("f32", flat<float>(matrix)); }

/// To 1/32767 of the largest entry: less than a pixel.
json levels(const Eigen::MatrixXd& matrix) {
    const double largest = matrix.size() > 0 ? matrix.cwiseAbs().maxCoeff() : 0;
    const double scale = largest > 0 ? largest / 32767 : 1;
    json result = packed("i16", flat<std::int16_t>((matrix / scale).array().round().matrix()));
    result["scale"] = scale;
    return result;
}

const Eigen::MatrixXd* find(const std::vector<mesh::DataArray>& arrays, const std::string& name) {
    const auto found = std::ranges::find(arrays, name, &mesh::DataArray::name);
    return found == arrays.end() ? nullptr : &found->values;
}

/// An array that our own series always have.
const Eigen::MatrixXd& array_of(const mesh::PolyData& part, const std::string& name, const fs::path& file) {
    const Eigen::MatrixXd* values = find(part.data.points, name);
    if (!values) throw InvalidInput(fmt::format("{}: has no array '{}'; run it again", file.string(), name));
    return *values;
}

/// The series of a model that plays a set.
struct Series {
    fs::path folder;
    std::string name;
    fs::path model = {};   // its file, where there is one
    json comparison = {};  // of it with the set, as compare.json has it; null where none was kept
    json forces_rms = {};  // of the errors of tools' forces over all states [N]; null where none was measured
    std::vector<mesh::SeriesStep> skin = {}, spheres = {}, markers = {}, loads = {};
};

Series series_in(const fs::path& folder, const std::string& name) {
    Series series{.folder = folder, .name = name, .model = folder / "model.json"};
    series.skin = mesh::read_pvd(folder / "skin.pvd");
    series.spheres = mesh::read_pvd(folder / "skeleton.pvd");
    series.markers = mesh::read_pvd(folder / "markers.pvd");
    series.loads = mesh::read_pvd(folder / "loads.pvd");
    return series;
}

std::vector<Series> all_series(const fs::path& run, const json& compare, const json& ladder) {
    std::vector<Series> all;
    for (std::size_t i = 0; !ladder.is_null() && i < ladder["steps"].size(); ++i) {
        const fs::path folder = run / "improve" / fmt::format("step_{}", i);
        if (!fs::exists(folder / "skeleton.pvd")) break;
        const auto effects = ladder["steps"][i]["effects"].get<std::vector<std::string>>();
        all.push_back(series_in(folder, effects.empty() ? "nothing added" : "with " + listed(effects)));
        all.back().forces_rms = ladder["steps"][i].value("reactions_rms_n", json());
    }
    if (!all.empty()) {  // the last one plays the model to use
        all.back().model = run / "improve/model.json";
        if (fs::exists(run / "improve/compare.json"))
            all.back().comparison = json_of_file(run / "improve/compare.json");
    } else if (fs::exists(run / "compare/skeleton.pvd")) {
        all.push_back(series_in(run / "compare", "as fitted"));
        all.back().model = run / "identify/model.json";
        all.back().forces_rms = compare["error"].value(json::json_pointer("/reactions/rms_n"), json());
    }
    if (!all.empty() && (all.size() == 1 || all.front().comparison.is_null())) all.front().comparison = compare;
    return all;
}

/// The set that was run on, for its tools; none where it is not there any more.
std::optional<identify::MeasurementSet> set_of(const fs::path& run) {
    try {
        const mesh::YamlFields settings = mesh::YamlFields::from_file(run / "case.yaml");
        const char* named = "measurements";  // simulated ones lie in the folder of this name
        return identify::read_measurement_set(run / (settings.has(named) ? settings.text(named) : named));
    } catch (const InvalidInput&) {
        return std::nullopt;
    } catch (const IoError&) {
        return std::nullopt;
    }
}

identify::StateName played_state(const mesh::PolyData& spheres, const fs::path& file) {
    return {static_cast<int>(array_of(spheres, "probe", file)(0, 0)), array_of(spheres, "time [s]", file)(0, 0)};
}

/// How wrong a model is in each state: rms over its markers [mm], or where forces alone were read the largest of them
/// [N].
std::vector<double> errors_of(const Series& series, const json& compare) {
    const json forces = compare.value("tool_forces", json::array());
    std::vector<double> errors;
    for (const mesh::SeriesStep& spheres : series.spheres) {
        const identify::StateName name = played_state(mesh::read_poly_data(spheres.file), spheres.file);
        double error = 0;
        for (const json& probe : compare["probes"])
            if (is_of_state(probe, name)) error = probe["rms_mm"].get<double>();
        for (const json& force : forces)
            if (compare["probes"].empty() && is_of_state(force, name))
                error = std::max(error, force["error_n"].get<double>());
        errors.push_back(error);
    }
    return errors;
}

/// The states to keep, in order: all, or those with the largest errors.
std::vector<std::size_t> kept_states(const Series& series, std::size_t most, const json& compare) {
    std::vector<std::size_t> states(series.skin.size());
    std::iota(states.begin(), states.end(), 0U);
    if (states.size() <= most) return states;
    const std::vector<double> errors = errors_of(series, compare);
    std::ranges::stable_sort(states, std::greater{}, [&](std::size_t s) { return errors[s]; });
    states.resize(most);
    std::ranges::sort(states);
    return states;
}

json state_json(const Series& series, std::size_t s, const json& held_out,
                const std::optional<identify::MeasurementSet>& set) {
    const mesh::PolyData spheres = mesh::read_poly_data(series.spheres[s].file);
    const mesh::PolyData skin = mesh::read_poly_data(series.skin[s].file);
    const mesh::PolyData loads = mesh::read_poly_data(series.loads[s].file);
    const identify::StateName name = played_state(spheres, series.spheres[s].file);
    json result = {{"probe", name.probe},
                   {"time", name.time},
                   {"held_out", std::ranges::find(held_out, json(name.probe)) != held_out.end()},
                   {"loads", json::array()},
                   {"tools", set ? tools_in_state(*set, name) : json::array()},
                   {"measured", nullptr}};
    if (const auto* measured = find(skin.data.points, "measured [mm]")) result["measured"] = levels(*measured);
    for (Eigen::Index c = 0; c < loads.points.rows(); ++c) {
        const Eigen::MatrixXd& force = array_of(loads, "force [N]", series.loads[s].file);
        if (force.row(c).norm() == 0) continue;
        result["loads"].push_back(
            {loads.points(c, 0), loads.points(c, 1), loads.points(c, 2), force(c, 0), force(c, 1), force(c, 2)});
    }
    return result;
}

json answer_json(const Series& series, std::size_t s) {
    const mesh::PolyData skin = mesh::read_poly_data(series.skin[s].file);
    const mesh::PolyData spheres = mesh::read_poly_data(series.spheres[s].file);
    const mesh::PolyData markers = mesh::read_poly_data(series.markers[s].file);
    const fs::path& file = series.markers[s].file;
    const Eigen::MatrixXd& measured = array_of(markers, "measured [mm]", file);
    return {{"skin", levels(array_of(skin, "displacement [mm]", series.skin[s].file))},
            {"spheres", levels(array_of(spheres, "displacement [mm]", series.spheres[s].file))},
            {"tool_forces", modelled_tool_forces(series.comparison, played_state(spheres, series.spheres[s].file))},
            {"markers",
             {{"id", flat<int>(array_of(markers, "marker", file))},
              {"coordinates", flat<int>(array_of(markers, "coordinates", file))},
              {"rest", floats(markers.points - measured)},
              {"measured", floats(measured)},
              {"error", floats(array_of(markers, "error [mm]", file))}}}};
}

/// An array "flexion_2 [N*mm/rad]" or "flexion_2 sd/mean [-]" of the links, in words.
json quantity_json(const mesh::DataArray& array) {
    const std::size_t open = array.name.find(" ["), end = array.name.rfind(']');
    const std::string kind = array.name.substr(0, array.name.find(' '));
    const bool is_relative = array.name.find("sd/mean") != std::string::npos;
    const std::string unit =
        is_relative || open == std::string::npos ? "" : array.name.substr(open + 2, end - open - 2);
    return {{"name", printed_stiffness(kind) + (is_relative ? ", relative sd" : "")},
            {"unit", printed_unit(unit)},
            {"relative", is_relative},
            {"values", floats(array.values)}};
}

/// Stiffnesses of the links, and how uncertain they are where there is a posterior.
json quantities_json(const mesh::PolyData& spheres, const std::vector<identify::PosteriorRow>& posterior) {
    json result = json::array();
    for (const mesh::DataArray& array : spheres.data.cells) {
        if (array.name != "zone" && !array.name.starts_with("vtk")) result.push_back(quantity_json(array));
    }
    const Eigen::MatrixXd* zones = find(spheres.data.cells, "zone");
    for (const mesh::DataArray& array :
         link_uncertainty(posterior, zones ? Eigen::VectorXd(zones->col(0)) : Eigen::VectorXd())) {
        result.push_back(quantity_json(array));
    }
    return result;
}

}  // namespace

json view_data(const fs::path& run, const json& record, const json& compare, const json& ladder, const json& diagnosis,
               const std::vector<identify::PosteriorRow>& posterior, std::size_t budget) {
    const std::vector<Series> all = all_series(run, compare, ladder);
    if (all.empty() || all.front().skin.empty()) return nullptr;

    // the body at rest
    const mesh::PolyData spheres = mesh::read_poly_data(all.front().spheres.front().file);
    const mesh::PolyData skin = mesh::read_poly_data(all.front().skin.front().file);
    json result = {
        {"surface",
         {{"points", floats(skin.points)}, {"triangles", packed("i32", flat<std::int32_t>(skin.triangles))}}},
        {"spheres",
         {{"centers", floats(spheres.points)},
          {"radii", floats(array_of(spheres, "radius [mm]", all.front().spheres.front().file))},
          {"held", flat<int>(array_of(spheres, "held", all.front().spheres.front().file))}}},
        {"links", packed("i32", flat<std::int32_t>(spheres.lines))},
        {"tools", json::array()},
        {"states", json::array()},
        {"steps", json::array()}};

    const std::optional<identify::MeasurementSet> set = set_of(run);
    if (set) result["tools"] = tools_at_rest(*set, skin.points, skin.triangles);
    budget -= std::min(budget, result["tools"].dump().size());

    // its states, and how each model answers them: 8 bytes of base64 a vertex, for each model and the measured shape
    const std::size_t size =
        8 * static_cast<std::size_t>(skin.points.rows() + spheres.points.rows()) * (all.size() + 1);
    const std::vector<std::size_t> states =
        kept_states(all.front(), std::max<std::size_t>(1, budget / std::max<std::size_t>(size, 1)), compare);
    json held_out = ladder.is_null() ? record.value("held_out_probes", json::array()) : ladder["held_out_probes"];
    for (const std::size_t s : states) result["states"].push_back(state_json(all.front(), s, held_out, set));
    // Where every probe was held out in turn, none is different from the others.
    if (std::ranges::all_of(result["states"], [](const json& state) { return state["held_out"].get<bool>(); })) {
        for (json& state : result["states"]) state["held_out"] = false;
    }
    result["exchanged"] = diagnosis.is_null() ? json::array() : diagnosis.value("exchanged_markers", json::array());
    result["outliers"] = diagnosis.is_null() ? json::array() : diagnosis.value("outlier_readings", json::array());
    result["left_out"] = all.front().skin.size() - states.size();
    for (const Series& series : all) {
        json step = {{"name", series.name}, {"states", json::array()}, {"forces_rms", series.forces_rms}};
        for (const std::size_t s : states) step["states"].push_back(answer_json(series, s));
        step["findings"] = fs::exists(series.model)
                               ? findings_json(skeleton::read_model(series.model).effects, diagnosis)
                               : json::array();
        const bool last = &series == &all.back();
        step["quantities"] = quantities_json(mesh::read_poly_data(series.spheres.front().file),
                                             last ? posterior : std::vector<identify::PosteriorRow>{});
        result["steps"].push_back(step);
    }
    return result;
}

}  // namespace palpate::pipeline
