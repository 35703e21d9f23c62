#include "pipeline/output/html/report.h"
#include "pipeline/command_line/subcommands.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/html/several/runs_page.h"
#include "pipeline/output/text/comparison/runs.h"
#include "pipeline/run/several/runs.h"

namespace palpate::pipeline::commands {
namespace {

/// Folders by their last names where these tell them apart, else as they were given.
std::vector<NamedRun> read_runs(const std::vector<std::filesystem::path>& folders) {
    std::vector<std::string> names;
    names.reserve(folders.size());
    for (const auto& folder : folders) names.push_back(std::filesystem::weakly_canonical(folder).filename().string());
    std::vector<NamedRun> runs;
    runs.reserve(folders.size());
    for (std::size_t r = 0; r < folders.size(); ++r)
        runs.push_back(
            {std::ranges::count(names, names[r]) == 1 ? names[r] : folders[r].string(), read_run(folders[r])});
    return runs;
}

Outcome compare_runs(const ReportOptions& options, const Common& common) {
    if (options.output.empty())
        throw InvalidInput(
            fmt::format("{} runs go side by side onto one page: say with -o where it is to lie, such as -o runs.html",
                        options.runs.size()));
    refuse_to_overwrite(options.output, common.force);
    Outcome outcome;
    outcome.json = runs_json(read_runs(options.runs));
    write_runs_page(options.output, outcome.json);
    outcome.text = runs_table(outcome.json) + fmt::format("Report: {}\n", options.output.string());
    return outcome;
}

}  // namespace

Outcome report(const ReportOptions& options, const Common& common) {
    if (options.runs.size() > 1) return compare_runs(options, common);
    const std::filesystem::path& run = options.runs.front();
    const std::filesystem::path page = options.output.empty() ? run / "report.html" : options.output;
    refuse_to_overwrite(page, common.force);
    write_report(run, page);
    return {.text = fmt::format("Report: {}\nOpen it in a browser; it needs no network.\n", page.string()),
            .json = {{"report", page.string()}}};
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_report(CLI::App& app) {
    auto* sub = subcommand(app, "report", "A run as one self-contained page, or several runs side by side.",
                           "  palpate report liver-run -o report.html\n"
                           "  palpate report coarse fine finest -o runs.html   which has the least error?\n",
                           [this] { return commands::report(report, common); });
    sub->add_option("RUN", report.runs, "The run folder; several are compared")->required();
    sub->add_option("-o,--output", report.output,
                    "The page; report.html in the run folder by default, required for several runs");
}

}  // namespace palpate::pipeline
