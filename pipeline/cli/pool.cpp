#include <fmt/format.h>

#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/html/several/population.h"
#include "pipeline/output/json/population.h"
#include "pipeline/output/text/comparison/population.h"
#include "pipeline/output/vtk/population_map.h"
#include "pipeline/run/several/shared_numbers.h"

namespace palpate::pipeline::commands {

Outcome pool(const PoolOptions& options, const Common& common) {
    const SharedBySpecimens shared = shared_by_specimens(options.runs);
    std::vector<identify::PooledNumber> pooled;
    pooled.reserve(shared.numbers.size());
    for (const SharedNumber& number : shared.numbers)
        pooled.push_back(identify::pool(number.specimens, number.most_spread));
    Outcome outcome;
    outcome.json = population_json(shared.numbers, pooled);
    outcome.json["no_map"] = shared.left_out > 0 ? nlohmann::json(shared.mean.why_none) : nlohmann::json(nullptr);
    outcome.text = population_tables(outcome.json);
    if (options.output.empty()) return outcome;
    refuse_to_overwrite(options.output, common.force);
    mesh::write_text(options.output / "population.json", outcome.json.dump(2) + "\n");
    const std::optional<skeleton::Model>& mean = shared.mean.model;
    std::vector<LinkMap> maps;
    if (mean) maps = maps_of_links(outcome.json, mean->links.size());
    write_population_page(options.output / "population.html", outcome.json, maps.empty() ? nullptr : &*mean, maps);
    if (!maps.empty()) {
        write_population_maps(options.output, *mean, maps);
        outcome.text += "Maps: mean_skeleton.vtp and mean_body.vtp, mean and spread of each stiffness (ParaView).\n";
    }
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
    sub->add_option("-o,--output", pool.output,
                    "Folder for population.json, population.html and, where skeletons correspond, maps");
}

}  // namespace palpate::pipeline
