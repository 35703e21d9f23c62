#include "pipeline/output/html/report.h"
#include "pipeline/command_line/subcommands.h"

#include <fmt/format.h>

#include "pipeline/command_line/commands.h"

namespace palpate::pipeline::commands {

Outcome report(const ReportOptions& options, const Common& common) {
    const std::filesystem::path page = options.output.empty() ? options.run / "report.html" : options.output;
    refuse_to_overwrite(page, common.force);
    write_report(options.run, page);
    return {.text = fmt::format("Report: {}\nOpen it in a browser; it needs no network.\n", page.string()),
            .json = {{"report", page.string()}}};
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_report(CLI::App& app) {
    auto* sub =
        subcommand(app, "report", "A run as one self-contained page.", "  palpate report liver-run -o report.html\n",
                   [this] { return commands::report(report, common); });
    sub->add_option("RUN", report.run, "The run folder")->required();
    sub->add_option("-o,--output", report.output, "The page; report.html in the run folder by default");
}

}  // namespace palpate::pipeline
