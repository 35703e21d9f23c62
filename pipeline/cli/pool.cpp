#include <fmt/format.h>

#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/html/several/population.h"
#include "pipeline/output/json/population.h"
#include "pipeline/output/text/comparison/population.h"
#include "pipeline/run/several/shared_numbers.h"

namespace palpate::pipeline::commands {

Outcome pool(const PoolOptions& options, const Common& common) {
    const std::vector<SharedNumber> numbers = shared_numbers(options.runs);
    std::vector<identify::PooledNumber> pooled;
    pooled.reserve(numbers.size());
    for (const SharedNumber& number : numbers) pooled.push_back(identify::pool(number.specimens, number.most_spread));
    Outcome outcome;
    outcome.json = population_json(numbers, pooled);
    outcome.text = population_tables(outcome.json);
    if (options.output.empty()) return outcome;
    refuse_to_overwrite(options.output, common.force);
    mesh::write_text(options.output / "population.json", outcome.json.dump(2) + "\n");
    write_population_page(options.output / "population.html", outcome.json);
    outcome.text += fmt::format("Report: {}\n", (options.output / "population.html").string());
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_pool(CLI::App& app) {
    auto* sub = subcommand(
        app, "pool", "Specimens of a kind together: their mean, how they differ, each one among the others.",
        "  palpate pool runs/liver-* -o livers\n  palpate pool first second third --json | jq .numbers[0].mean\n",
        [this] { return commands::pool(pool, common); });
    sub->add_option("RUN", pool.runs, "Run folders, each of a specimen of its own")->required();
    sub->add_option("-o,--output", pool.output, "Folder for population.json and population.html");
}

}  // namespace palpate::pipeline
