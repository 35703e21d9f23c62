#include "pipeline/output/html/sections/fit_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/charts/charts.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

struct Trace {
    ChartLine fit{"−ln of the posterior density", {}}, temperature{"tempering exponent", {}},
        samples{"effective samples", {}};
    /// No search was recorded, and the particles are of the posterior from the beginning.
    bool was_drawn_at_once() const {
        return fit.points.empty() && temperature.points.size() == 1 && temperature.points.front().second == 1;
    }
};

/// convergence.csv: stage,step,minus_log_density,temperature,effective_samples, empty where a stage has none.
Trace read_trace(const std::filesystem::path& file) {
    std::istringstream lines(mesh::read_text(file));
    std::string line;
    std::getline(lines, line);
    Trace trace;
    while (std::getline(lines, line)) {
        std::istringstream cells(line);
        std::vector<std::string> cell;
        for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
        const auto add = [&](ChartLine& curve, std::size_t column) {
            if (column < cell.size() && !cell[column].empty()) {
                curve.points.emplace_back(std::stod(cell[1]), std::stod(cell[column]));
            }
        };
        add(trace.fit, 2);
        add(trace.temperature, 3);
        add(trace.samples, 4);
    }
    return trace;
}

std::string drawn_words(const Trace& trace) {
    return fmt::format(
        "The particles were drawn in one step from the normal distribution about the best fit (Laplace's approximation "
        "of the posterior): {:.0f} effective samples.</p>",
        trace.samples.points.empty() ? 0 : trace.samples.points.front().second);
}

}  // namespace

std::string convergence_section(const std::filesystem::path& convergence) {
    if (!std::filesystem::exists(convergence)) return {};
    const Trace trace = read_trace(convergence);
    const std::string heading = "<h2 id=\"convergence\">Convergence</h2><p>",
                      search = line_chart({trace.fit}, "Search: −ln of the posterior density", "step"),
                      tempering = line_chart({trace.samples}, "Particles: effective samples", "step") +
                                  line_chart({trace.temperature}, "Particles: tempering exponent", "step");
    if (search.empty() && tempering.empty()) return trace.was_drawn_at_once() ? heading + drawn_words(trace) : "";
    std::string words;
    if (!search.empty()) words += "An optimiser found the most probable stiffnesses. ";
    if (!tempering.empty())
        words +=
            "The particles were tempered from a proposal (exponent 0) to the posterior (exponent 1); with few "
            "effective samples the posterior is poorly resolved.";
    return heading + words + "</p><div class=\"pair\">" + search + tempering + "</div>";
}

std::string spheres_section(const json& quality) {
    if (quality.is_null()) return {};
    ChartLine rms{"rms", {}}, median{"median", {}}, p90{"90th percentile", {}};
    for (const json& step : quality["rungs"]) {
        const double spheres = step["spheres"].get<double>();
        rms.points.emplace_back(spheres, 100 * step["error"]["rms"].get<double>());
        median.points.emplace_back(spheres, 100 * step["error"]["median"].get<double>());
        p90.points.emplace_back(spheres, 100 * step["error"]["p90"].get<double>());
    }
    const auto own = std::ranges::find_if(quality["rungs"], [](const json& step) { return step["own"].get<bool>(); });
    return fmt::format(
               "<h2 id=\"spheres\">Number of spheres</h2><p>How well skeletons of this body, fitted link by link, "
               "follow it in "
               "finite elements, on probes that were held out. This run has {} free spheres; <code>--spheres N</code> "
               "changes that.</p><div class=\"pair\">",
               (*own)["spheres"].get<int>()) +
           line_chart({p90, rms, median}, "Error over displacement [%]", "free spheres") + "</div>";
}

}  // namespace palpate::pipeline
