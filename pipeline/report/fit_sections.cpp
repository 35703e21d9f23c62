#include "pipeline/report/fit_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "mesh/io/atomic_file.h"
#include "pipeline/report/charts.h"
#include "pipeline/report/escape.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// 95 % of a log-normal prior of this mean and sd.
std::pair<double, double> prior_interval(const identify::PosteriorRow& row) {
    const double variance = std::log1p(std::pow(row.prior_sd / row.prior_mean, 2));  // of the logarithm
    const double middle = std::log(row.prior_mean) - variance / 2, reach = 1.96 * std::sqrt(variance);
    return {std::exp(middle - reach), std::exp(middle + reach)};
}

struct Trace {
    ChartLine fit{"−ln of the posterior density", {}}, temperature{"temperature", {}}, samples{"effective samples", {}};
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

}  // namespace

std::string stiffness_section(const std::vector<identify::PosteriorRow>& posterior, const std::string& file) {
    constexpr std::size_t most = 16;
    std::map<std::string, std::vector<Interval>> by_unit;
    std::vector<const identify::PosteriorRow*> rows;
    rows.reserve(posterior.size());
    for (const auto& row : posterior) rows.push_back(&row);
    std::stable_sort(rows.begin(), rows.end(), [](auto* a, auto* b) { return a->informed > b->informed; });
    for (const auto* row : rows) {
        auto& list = by_unit[row->unit];
        if (list.size() == most || row->q025 <= 0 || row->prior_mean <= 0) continue;
        const auto [low, high] = prior_interval(*row);
        list.push_back({row->parameter + (row->informed ? " ●" : ""), row->q025, row->q50, row->q975, low, high});
    }
    const auto informed = std::ranges::count_if(posterior, [](const auto& row) { return row.informed; });
    std::string html = fmt::format(
        "<h2 id=\"stiffness\">Stiffness</h2><p>{} of {} numbers are known better than before (●): the others are what "
        "the body's shape and first material make them.</p><div class=\"pair\">",
        informed, posterior.size());
    for (const auto& [unit, list] : by_unit) html += interval_chart(list, "Stiffness", unit);
    return html +
           "</div><p class=\"soft\">Grey: 95 % of the prior. Blue: 95 % of the posterior, with its median. All numbers "
           "are in " +
           escape(file) + ".</p>";
}

std::string convergence_section(const std::filesystem::path& convergence) {
    if (!std::filesystem::exists(convergence)) return {};
    const Trace trace = read_trace(convergence);
    return "<h2 id=\"convergence\">Convergence</h2><p>The search went down to the most probable stiffnesses; then "
           "particles went from a proposal (temperature 0) to the posterior (1). Few effective samples mean a coarse "
           "picture of it.</p><div class=\"pair\">" +
           line_chart({trace.fit}, "Search: −ln of the posterior density", "step") +
           line_chart({trace.samples}, "Particles: effective samples", "step") +
           line_chart({trace.temperature}, "Particles: temperature", "step") + "</div>";
}

std::string spheres_section(const json& quality) {
    if (quality.is_null()) return {};
    ChartLine rms{"rms", {}}, median{"median", {}}, p90{"90th percentile", {}};
    for (const json& rung : quality["rungs"]) {
        const double spheres = rung["spheres"].get<double>();
        rms.points.emplace_back(spheres, 100 * rung["error"]["rms"].get<double>());
        median.points.emplace_back(spheres, 100 * rung["error"]["median"].get<double>());
        p90.points.emplace_back(spheres, 100 * rung["error"]["p90"].get<double>());
    }
    return "<h2 id=\"spheres\">Number of spheres</h2><p>How well skeletons of this body follow it, on probes that were "
           "held out.</p><div class=\"pair\">" +
           line_chart({p90, rms, median}, "Error over displacement [%]", "spheres") + "</div>";
}

}  // namespace palpate::pipeline
