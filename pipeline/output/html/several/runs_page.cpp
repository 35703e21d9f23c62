#include "pipeline/output/html/several/runs_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/page/page_parts.h"
#include "pipeline/output/text/runs.h"

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

std::string in_table(const std::string& rows) { return "<div class=\"wide\"><table>" + rows + "</table></div>"; }

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

std::string error_chart(const json& runs) {
    std::vector<BarGroup> groups;
    for (const json& run : runs["runs"]) {
        BarGroup group{run["run"].get<std::string>(), {}};
        group.bars.push_back({"nothing added", run["rms_mm"]["nothing_added"].get<double>(), false});
        if (!run["effects"].empty())
            group.bars.push_back({"with what was added", run["rms_mm"]["now"].get<double>(), false});
        if (run["held_out_rms_mm"].is_number())
            group.bars.push_back({"held out", run["held_out_rms_mm"].get<double>(), true});
        groups.push_back(group);
    }
    return "<div class=\"pair\"><figure>" + group_chart(groups, "Error of the model", "mm rms") +
           "<figcaption class=\"soft\">For each run: nothing added, with what was added, and with that on held-out "
           "probes (orange), as far as there is such.</figcaption></figure></div>";
}

std::string settings_table(const json& runs) {
    if (runs["settings"].empty()) return "<p>All settings are alike.</p>";
    std::string rows = heading(runs, "setting");
    for (const json& one : runs["settings"]) {
        rows += "<tr>" + table_cell(one["setting"].get<std::string>());
        for (const json& value : one["values"]) rows += table_cell(value.get<std::string>());
        rows += "</tr>";
    }
    return in_table(rows);
}

/// The least error of each state stands out, where it is less than the others as far as they are told.
std::string state_table(const json& runs) {
    std::string rows = heading(runs, "state");
    for (const json& state : runs["states"]) {
        std::vector<std::string> errors;
        errors.reserve(state["rms_mm"].size());
        for (const json& rms : state["rms_mm"]) errors.push_back(fmt::format("{:.3g}", rms.get<double>()));
        const std::string& least =
            *std::ranges::min_element(errors, {}, [](const auto& told) { return std::stod(told); });
        const bool stands_out = std::ranges::count(errors, least) == 1;
        rows += "<tr>" +
                table_cell(fmt::format("probe {}, time {:g}", state["probe"].get<int>(), state["time"].get<double>()));
        for (const std::string& told : errors)
            rows += table_cell(told, stands_out && told == least ? " style=\"font-weight:600\"" : "");
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
    mesh::write_text(page,
                     "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                     "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
                     "<meta name=\"generator\" content=\"palpate\"><link rel=\"icon\" href=\"data:,\">"
                     "<title>Runs compared</title><style>" +
                         std::string(page_style) + "</style></head><body><main><h1>Runs compared</h1>" + sections +
                         "</main></body></html>\n");
}

}  // namespace palpate::pipeline
