#include "pipeline/output/html/several/runs_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/page/page_parts.h"
#include "pipeline/output/html/page_frame.h"
#include "pipeline/output/text/comparison/runs.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string table_cell(const std::string& text, const char* attributes = "") {
    return fmt::format("<td{}>{}</td>", attributes, escape(text));
}

std::string heading(const json& runs, const char* first) {
    std::string row = fmt::format("<tr><th>{}</th>", first);
    for (const json& run : runs["runs"]) row += "<th>" + escape(run["run"].get<std::string>()) + "</th>";
    return row + "</tr>";
}

std::string in_table(const std::string& rows) {
    return "<div class=\"wide\" tabindex=\"0\"><table>" + rows + "</table></div>";
}

/// One column a run, one row a number: the best run is marked.
std::string overview(const json& runs) {
    std::string rows = heading(runs, "Run");
    for (const RunNumber& number : run_numbers(runs)) {
        rows += "<tr>" + table_cell(number.name);
        for (std::size_t r = 0; r < number.of_runs.size(); ++r)
            rows += table_cell(number.of_runs[r], number.best == r ? " style=\"font-weight:600\"" : "");
        rows += "</tr>";
    }
    return in_table(rows);
}

/// Errors of a run: how they are called, and how much they are.
std::vector<Bar> bars_of_run(const json& run) {
    const bool is_in_mm = run["rms_n"].is_null();
    const json& fitted = is_in_mm ? run["rms_mm"] : run["rms_n"];
    const json& held_out = is_in_mm ? run["held_out_rms_mm"] : run["rms_n"]["held_out"];
    std::vector<Bar> bars{{"nothing added", fitted["nothing_added"].get<double>(), false}};
    if (!run["effects"].empty()) bars.push_back({"with what was added", fitted["now"].get<double>(), false});
    if (held_out.is_number()) bars.push_back({"held out", held_out.get<double>(), true});
    return bars;
}

/// A bar a line with its value behind it, as any number of runs and any values leave room for.
std::string error_chart(const json& runs) {
    constexpr double chart_width = 640, longest = 380, bars_from = 170, line = 20, title_room = 28;  // [px]
    double highest = 0, lines = 0;
    for (const json& run : runs["runs"]) {
        const std::vector<Bar> bars = bars_of_run(run);
        lines += static_cast<double>(bars.size()) + 1.5;
        for (const Bar& bar : bars) highest = std::max(highest, bar.value);
    }
    if (highest <= 0) return {};
    std::string svg = open_svg(chart_width, title_room + line * lines, "Error of the model of each run") +
                      words_at(0, 16, "Error of the model, rms");
    double y = title_room;
    for (const json& run : runs["runs"]) {
        const char* unit = run["rms_n"].is_null() ? "mm" : "N";
        svg += words_at(0, y + 14, run["run"].get<std::string>());
        y += line;
        for (const Bar& bar : bars_of_run(run)) {
            const double length = longest * bar.value / highest;
            svg += words_at(16, y + 14, bar.label) +
                   fmt::format(R"(<rect class="bar{}" x="{:.0f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/>)",
                               bar.highlighted ? " held-out" : "", bars_from, y + 2, length, line - 4) +
                   words_at(bars_from + length + 6, y + 14, fmt::format("{:.3g} {}", bar.value, unit));
            y += line;
        }
        y += 0.5 * line;
    }
    return "<figure style=\"max-width:40rem\">" + svg +
           "</svg><figcaption class=\"soft\">For each run: nothing added, with what was added, and with that on "
           "held-out probes (orange), where there are any.</figcaption></figure>";
}

std::string settings_table(const json& runs) {
    if (runs["settings"].empty()) return "<p>All settings are the same.</p>";
    std::string rows = heading(runs, "setting");
    for (const json& one : runs["settings"]) {
        rows += "<tr>" + table_cell(one["setting"].get<std::string>());
        for (const json& value : one["values"]) rows += table_cell(value.get<std::string>());
        rows += "</tr>";
    }
    return in_table(rows);
}

/// The least error of each state stands out, where errors can be ranked and it is less than the others to the digits
/// reported.
std::string state_table(const json& runs) {
    std::string rows = heading(runs, "state");
    for (const json& state : runs["states"]) {
        std::vector<std::string> errors;
        errors.reserve(state["rms_mm"].size());
        for (const json& rms : state["rms_mm"]) errors.push_back(fmt::format("{:.3g}", rms.get<double>()));
        const std::string& least =
            *std::ranges::min_element(errors, {}, [](const auto& text) { return std::stod(text); });
        const bool stands_out = can_be_ranked(runs) && std::ranges::count(errors, least) == 1;
        rows += "<tr>" +
                table_cell(fmt::format("probe {}, time {:g}", state["probe"].get<int>(), state["time"].get<double>()));
        for (const std::string& error : errors)
            rows += table_cell(error, stands_out && error == least ? " style=\"font-weight:600\"" : "");
        rows += "</tr>";
    }
    return in_table(rows);
}

}  // namespace

void write_runs_page(const std::filesystem::path& page, const json& runs) {
    std::string sections = "<p class=\"lead\">" + escape(best_run_in_words(runs)) + "</p>" + overview(runs) +
                           "<h2>Errors</h2>" + error_chart(runs) + "<h2>Settings that differ</h2>" +
                           settings_table(runs);
    if (runs["same_states"].get<bool>())
        sections += "<h2>Error of each state, with what was added [mm rms]</h2>" + state_table(runs);
    mesh::write_text(page, page_head("Runs compared", page_style) + "<body><main><h1>Runs compared</h1>" + sections +
                               "</main></body></html>\n");
}

}  // namespace palpate::pipeline
