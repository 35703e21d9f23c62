#include <fmt/format.h>

#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/text/describe/describe.h"

namespace palpate::pipeline::commands {

Outcome info(const InfoOptions& options, const Common&) {
    const Description description = describe(options.file);
    Outcome outcome;
    outcome.text = fmt::format("{}: {}\n", options.file.string(), description.kind);
    for (const std::string& line : description.lines) outcome.text += line + "\n";
    if (!description.next.empty()) outcome.text += "Next: " + description.next + "\n";
    outcome.json = {{"file", options.file.string()},
                    {"kind", description.kind},
                    {"lines", description.lines},
                    {"next", description.next}};
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_info(CLI::App& app) {
    auto* sub = subcommand(
        app, "info", "What any of our files holds.",
        "  palpate info liver-run\n  palpate info liver-run/identify/posterior.csv\n  palpate info model.json --json\n",
        [this] { return commands::info(info, common); });
    sub->add_option("FILE", info.file, "A run folder, set, case, model, result, table, series or mesh")->required();
}

}  // namespace palpate::pipeline
