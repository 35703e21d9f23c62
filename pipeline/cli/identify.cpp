#include <fmt/format.h>

#include <memory>

#include "identify/identify.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/live/follow.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/results/identification.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/identification.h"
#include "pipeline/output/vtk/series.h"
#include "pipeline/run/inputs/model_and_set.h"

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

namespace {

constexpr std::string_view socket_prefix = "unix:";
bool is_socket(const std::string& from) { return from.starts_with(socket_prefix); }

}  // namespace

/// What follows a set, standard input or a socket, with the options that the command shares.
Outcome follow(FollowOptions options, const IdentifyCommandOptions& shared, const std::string& from,
               const Common& common) {
    options.model = shared.model;
    options.standard_input = from == "-";
    if (is_socket(from)) options.socket = from.substr(socket_prefix.size());
    options.set = options.standard_input || is_socket(from) ? shared.set : fs::path(from);
    options.output = shared.output.empty() ? fs::path("identified") : shared.output;
    const bool goes_on = fs::exists(options.output / "cloud.json");
    if (!goes_on) refuse_to_overwrite(options.output, common.force);
    options.how = shared.overrides.on_defaults().identify;
    options.how.seed = common.seed.value_or(options.how.seed);
    options.how.threads = common.threads;
    options.filter.seed = options.how.seed;
    if (options.how.particles > 0) options.filter.particles = options.how.particles;
    return follow(options, common);
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_identify(CLI::App& app) {
    auto live = std::make_shared<commands::FollowOptions>();
    auto from = std::make_shared<std::string>();
    auto* sub = subcommand(
        app, "identify", "Stiffness per link by particle filter.",
        "  palpate identify model.json set/ -o fitted --parameters zones\n"
        "  palpate identify model.json set/ --fixed torsion -o fitted     # known: not fitted\n\n"
        "Prior: each stiffness is log-normal about the model's own, which follows from its sections\n"
        "and the material ('palpate skeleton --young'); posterior.csv contains its mean and sd. To move\n"
        "it, edit model.json; --prior takes it from other specimens ('palpate pool'). burion2008 takes\n"
        "an even one from --search-low to --search-high times the model's own.\n\n"
        "  palpate identify model.json --follow set/ -o live    # while another program appends rows\n"
        "  rig | palpate identify model.json set/ --follow - -o live --json\n"
        "  palpate identify model.json set/ --follow unix:rig.sock -o live    # answers each line there\n\n"
        "It calibrates with the first readings that are there, then takes in each new one and reports what\n"
        "became of it. Killed and begun again it goes on from live/cloud.json. Lines of - and of a socket are\n"
        "{\"probe\": 3, \"time\": 0, \"contacts\": [{\"at\": [x,y,z], \"force\": [fx,fy,fz]}],\n"
        "\"markers\": {\"12\": [x,y,z]}} in mm, N and s.\n",
        [this, live, from] {
            if (!from->empty()) return commands::follow(*live, identify, *from, common);
            return commands::identify(identify, common);
        });
    sub->add_option("MODEL", identify.model, "model.json")->required();
    sub->add_option("SET", identify.set, "The measurements");
    sub->add_option("--follow", *from,
                    "Take in readings as they come: a SET that grows, - for standard input, or unix:PATH for a socket");
    sub->add_option("--follow-timeout", live->timeout, "End after so long without a reading [s]; 0: never")
        ->check(CLI::NonNegativeNumber);
    sub->add_option("--forgetting", live->filter.forgetting,
                    "With --follow: the share of what is known that each reading leaves; 1: nothing is forgotten");
    sub->add_option("-o,--output", identify.output,
                    "Folder for model.json, posterior.csv, history.pvd; identified by default");
    sub->parse_complete_callback([this, from] {
        const bool follows_a_set = !from->empty() && *from != "-" && !commands::is_socket(*from);
        if (identify.set.empty() && !follows_a_set) throw CLI::RequiredError("SET");
        if (!identify.set.empty() && follows_a_set) {
            throw CLI::ValidationError("--follow",
                                       "names a set, and so does SET; give one of them, or --follow - or unix:PATH");
        }
    });
    add_flags_of(sub, identify.overrides, "Identification");
}

}  // namespace palpate::pipeline
