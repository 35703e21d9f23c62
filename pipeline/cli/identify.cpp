#include <fmt/format.h>

#include "identify/identify.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/identification.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/text/comparison.h"
#include "pipeline/output/vtk/series.h"
#include "pipeline/run/model_and_set.h"

namespace palpate::pipeline::commands {

namespace fs = std::filesystem;

identify::IdentifyResult identify(const ModelAndSet& given, const CaseOverrides& overrides, const Common& common) {
    identify::IdentifyOptions how = overrides.on_defaults().identify;
    how.seed = common.seed.value_or(how.seed);
    how.threads = common.threads;
    identify::IdentifyResult found = identify::identify(given.model, given.set, how, Console::progress());
    found.damping = damping_of(found.model, given.set, how.seed, common);
    return found;
}

Outcome identify(const IdentifyCommandOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("identified") : options.output;
    refuse_to_overwrite(output, common.force);
    const identify::IdentifyResult found =
        identify(read_model_and_set(options.model, options.set), options.overrides, common);
    write_identification(output, found);

    Outcome outcome;
    outcome.json = summary_json(found);
    outcome.json["model"] = (output / "model.json").string();
    const std::string fitted = (output / "model.json").string();
    outcome.text = fmt::format("{}:\n{}Next: palpate compare {} {}\n", fitted, identification_in_words(found), fitted,
                               options.set.string());
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_identify(CLI::App& app) {
    auto* sub =
        subcommand(app, "identify", "Stiffness per link by particle filter.",
                   "  palpate identify model.json set/ -o fitted --parameters zones\n"
                   "  palpate identify model.json set/ --fixed torsion -o fitted     # known: not fitted\n\n"
                   "Prior: each stiffness is log-normal about the model's own, which follows from its sections\n"
                   "and the material ('palpate skeleton --young'); posterior.csv tells its mean and sd. To move\n"
                   "it, edit model.json. burion2008 takes an even one from --search-low to --search-high times\n"
                   "the model's own.\n",
                   [this] { return commands::identify(identify, common); });
    sub->add_option("MODEL", identify.model, "model.json")->required();
    sub->add_option("SET", identify.set, "The measurements")->required();
    sub->add_option("-o,--output", identify.output,
                    "Folder for model.json, posterior.csv, history.pvd; identified by default");
    add_flags_of(sub, identify.overrides, "Identification");
}

}  // namespace palpate::pipeline
