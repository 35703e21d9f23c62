#include "pipeline/output/html/sections/damping_section.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "mesh/text/atomic_file.h"
#include "pipeline/case/json_file.h"
#include "pipeline/output/damping.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/run_files.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// A chart of each recording in damping.csv: probe,marker,axis,time,measured,played.
std::string trace_charts(const std::filesystem::path& file) {
    struct Curves {
        std::string marker, axis;
        ChartLine measured{"measured", {}, ChartLine::Drawn::dots}, played{"model", {}, ChartLine::Drawn::line};
    };
    std::map<int, Curves> of_probe;
    std::istringstream lines(mesh::read_text(file));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::istringstream cells(line);
        std::vector<std::string> cell;
        for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
        if (cell.size() != 6) continue;
        Curves& curves = of_probe[std::stoi(cell[0])];
        curves.marker = cell[1];
        curves.axis = cell[2];
        const double time = std::stod(cell[3]);
        curves.measured.points.emplace_back(time, std::stod(cell[4]));
        curves.played.points.emplace_back(time, std::stod(cell[5]));
    }
    std::string html;
    for (const auto& [probe, curves] : of_probe) {
        html +=
            line_chart({curves.measured, curves.played},
                       fmt::format("Probe {}: {} of marker {} [mm]", probe, curves.axis, curves.marker), "time [s]");
    }
    return html;
}

std::string mode_table(const json& modes) {
    std::string rows;
    for (const json& mode : modes) {
        rows += fmt::format("<tr><td>{:.3g}</td><td>{}</td><td>{}{}</td><td>{:.3g}</td><td>{:.1f} %</td></tr>",
                            mode["frequency_hz"].get<double>(), interval_in_words(mode["measured_hz"]),
                            interval_in_words(mode["ratio"]), mode["ratio"]["informed"].get<bool>() ? " ●" : "",
                            mode["played_ratio"].get<double>(), 100 * mode["share"].get<double>());
    }
    return "<div class=\"wide\" tabindex=\"0\"><table><tr><th>model [Hz]</th><th>measured [Hz]</th><th>damping "
           "ratio</th>"
           "<th>as played</th><th>share of the motion</th></tr>" +
           rows + "</table></div>";
}

}  // namespace

std::string damping_section(const std::filesystem::path& folder) {
    if (!std::filesystem::exists(folder / "damping.csv")) return {};
    const json damping = json_of_file(folder / "identify.json")["damping"];
    std::string html = fmt::format(
        "<h2 id=\"damping\">Damping</h2><p>The slowest observed vibration has a damping ratio of {}; {}. The model "
        "follows "
        "the motion of {:.3g}&nbsp;mm rms to within {:.2g}&nbsp;mm.</p><div class=\"pair\">{}</div>{}",
        interval_in_words(damping["modes"][0]["ratio"]), how_it_goes(damping), damping["displacement_mm"].get<double>(),
        damping["rms_mm"].get<double>(), trace_charts(folder / "damping.csv"), mode_table(damping["modes"]));
    for (const json& note : damping["notes"]) html += "<p>" + prose(note.get<std::string>()) + "</p>";
    return html +
           "<p class=\"soft\">Intervals hold 95 % of the posterior; ● narrower than the prior. As played: by the "
           "damping in model.json, two coefficients for all modes.</p>";
}

}  // namespace palpate::pipeline
