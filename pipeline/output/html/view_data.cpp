#include "pipeline/output/html/view_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "mesh/errors.h"
#include "mesh/formats/vtk/poly_data.h"
#include "pipeline/analysis/link_uncertainty.h"
#include "pipeline/output/findings.h"
#include "pipeline/output/html/packed_rows.h"
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
    fs::path model = {};  // its file, where there is one
    std::vector<mesh::SeriesStep> skin, spheres, markers, loads;
};

Series series_in(const fs::path& folder, const std::string& name) {
    return {folder,
            name,
            folder / "model.json",
            mesh::read_pvd(folder / "skin.pvd"),
            mesh::read_pvd(folder / "skeleton.pvd"),
            mesh::read_pvd(folder / "markers.pvd"),
            mesh::read_pvd(folder / "loads.pvd")};
}

std::vector<Series> all_series(const fs::path& run, const json& ladder) {
    std::vector<Series> all;
    for (std::size_t i = 0; !ladder.is_null() && i < ladder["steps"].size(); ++i) {
        const fs::path folder = run / "improve" / fmt::format("step_{}", i);
        if (!fs::exists(folder / "skeleton.pvd")) break;
        const auto effects = ladder["steps"][i]["effects"].get<std::vector<std::string>>();
        all.push_back(series_in(folder, effects.empty() ? "nothing added" : "with " + listed(effects)));
    }
    if (!all.empty()) all.back().model = run / "improve/model.json";  // which the last one plays
    if (all.empty() && fs::exists(run / "compare/skeleton.pvd")) {
        all.push_back(series_in(run / "compare", "as fitted"));
        all.back().model = run / "identify/model.json";
    }
    return all;
}

/// The states to keep, in order: all, or those with the largest errors.
std::vector<std::size_t> kept_states(const Series& series, std::size_t most, const json& compare) {
    std::vector<std::size_t> states(series.skin.size());
    std::iota(states.begin(), states.end(), 0U);
    const json& probes = compare["probes"];
    if (states.size() <= most || probes.size() != states.size()) {
        states.resize(std::min(states.size(), most));
        return states;
    }
    std::ranges::stable_sort(states, std::greater{}, [&](std::size_t s) { return probes[s]["rms_mm"].get<double>(); });
    states.resize(most);
    std::ranges::sort(states);
    return states;
}

json state_json(const Series& series, std::size_t s, const json& held_out) {
    const mesh::PolyData spheres = mesh::read_poly_data(series.spheres[s].file);
    const mesh::PolyData skin = mesh::read_poly_data(series.skin[s].file);
    const mesh::PolyData loads = mesh::read_poly_data(series.loads[s].file);
    const int probe = static_cast<int>(array_of(spheres, "probe", series.spheres[s].file)(0, 0));
    json result = {{"probe", probe},
                   {"time", array_of(spheres, "time [s]", series.spheres[s].file)(0, 0)},
                   {"held_out", std::ranges::find(held_out, json(probe)) != held_out.end()},
                   {"loads", json::array()},
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
            {"markers",
             {{"id", flat<int>(array_of(markers, "marker", file))},
              {"coordinates", flat<int>(array_of(markers, "coordinates", file))},
              {"rest", floats(markers.points - measured)},
              {"measured", floats(measured)},
              {"error", floats(array_of(markers, "error [mm]", file))}}}};
}

/// Stiffnesses of the links, and how uncertain they are where a posterior tells.
json quantities_json(const mesh::PolyData& spheres, const std::vector<identify::PosteriorRow>& posterior) {
    json result = json::array();
    for (const mesh::DataArray& array : spheres.data.cells) {
        if (array.name != "zone" && !array.name.starts_with("vtk")) {
            result.push_back({{"name", array.name}, {"values", floats(array.values)}});
        }
    }
    const Eigen::MatrixXd* zones = find(spheres.data.cells, "zone");
    for (const mesh::DataArray& array :
         link_uncertainty(posterior, zones ? Eigen::VectorXd(zones->col(0)) : Eigen::VectorXd())) {
        result.push_back({{"name", array.name}, {"values", floats(array.values)}});
    }
    return result;
}

}  // namespace

json view_data(const fs::path& run, const json& record, const json& compare, const json& ladder, const json& diagnosis,
               const std::vector<identify::PosteriorRow>& posterior, std::size_t budget) {
    const std::vector<Series> all = all_series(run, ladder);
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
        {"states", json::array()},
        {"steps", json::array()}};

    // its states, and how each model answers them: 8 bytes of base64 a vertex, for each model and the measured shape
    const std::size_t size =
        8 * static_cast<std::size_t>(skin.points.rows() + spheres.points.rows()) * (all.size() + 1);
    const std::vector<std::size_t> states =
        kept_states(all.front(), std::max<std::size_t>(1, budget / std::max<std::size_t>(size, 1)), compare);
    json held_out = ladder.is_null() ? record.value("held_out_probes", json::array()) : ladder["held_out_probes"];
    for (const std::size_t s : states) result["states"].push_back(state_json(all.front(), s, held_out));
    // Where every probe was held out in turn, none is different from the others.
    if (std::ranges::all_of(result["states"], [](const json& state) { return state["held_out"].get<bool>(); })) {
        for (json& state : result["states"]) state["held_out"] = false;
    }
    result["exchanged"] = diagnosis.is_null() ? json::array() : diagnosis.value("exchanged_markers", json::array());
    result["outliers"] = diagnosis.is_null() ? json::array() : diagnosis.value("outlier_readings", json::array());
    result["left_out"] = all.front().skin.size() - states.size();
    for (const Series& series : all) {
        json step = {{"name", series.name}, {"states", json::array()}};
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
