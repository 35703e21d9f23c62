#include "identify/diagnosis/diagnose.h"

#include <fmt/format.h>

#include <set>

#include "identify/effects/catalogue.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/json/diagnosis.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/vtk/missing_series.h"
#include "pipeline/output/vtk/stiffness_map_file.h"
#include "pipeline/run/inputs/model_and_set.h"

namespace palpate::pipeline::commands {

Diagnosed diagnose(const ModelAndSet& given, const DiagnoseCommandOptions& options, const Common& common) {
    RunDiagnosisOptions wanted = options.overrides.on_defaults().diagnose;
    wanted.without = options.without;
    const identify::DiagnoseOptions how = diagnose_options(wanted, given.set.density.has_value(), given.model, common);
    const auto body = body_to_diagnose(options.body, given, options.overrides.on_defaults());
    const identify::Diagnosis found = identify::diagnose(*body, given.set, how, Console::progress());
    const std::string field = options.output.empty() ? "" : write_missing_series(options.output, given.set, found);
    const auto* solid = dynamic_cast<const identify::ReferenceBody*>(body.get());
    Diagnosed diagnosed{to_json(found, *body, given.set, field), found.explanation, found.notes};
    if (solid && !options.output.empty() && write_stiffness_map(options.output, solid->body().mesh(), given.set, found))
        diagnosed.regions = options.output / map_regions;
    return diagnosed;
}

Outcome diagnose(const DiagnoseCommandOptions& options, const Common& common) {
    if (!options.output.empty()) refuse_to_overwrite(options.output, common.force);
    for (const std::string& name : options.without) identify::find_effect(name);
    const Diagnosed found = diagnose(read_model_and_set(options.model, options.set), options, common);

    Outcome outcome;
    outcome.json = found.json;
    outcome.text = diagnosis_in_words(outcome.json) + "\n";
    for (const std::string& note : found.notes) outcome.text += "  " + note + "\n";
    if (!options.output.empty()) {
        mesh::write_text(options.output / "diagnosis.json", outcome.json.dump(2) + "\n");
        outcome.text += fmt::format("Written: {}\n", (options.output / "diagnosis.json").string());
    }
    if (outcome.json["verdict"] == "missing-effect") {
        outcome.text += fmt::format("Next: palpate improve {} {}", options.model.string(), options.set.string());
        const std::set<std::string> different(found.explanation.begin(), found.explanation.end());
        if (different.size() < found.explanation.size())
            outcome.text += " --auto";  // finds several of one kind again: their names do not tell them apart
        else
            for (const std::string& effect : found.explanation) outcome.text += " --add " + effect;
        outcome.text += options.body == "skeleton" ? " --body skeleton -o improved\n" : " -o improved\n";
        if (!found.regions.empty())
            outcome.text += fmt::format("Or, with the map's parts as regions: palpate run {} -o with-regions\n",
                                        found.regions.string());
    } else if (outcome.json["verdict"] == "ambiguous") {
        outcome.text += "Next: add that probe to the set, and diagnose again\n";
    } else if (outcome.json["verdict"] == "unexplained" && outcome.json["where"].is_object() &&
               outcome.json["where"]["kind"] != "sensor") {
        outcome.text += fmt::format("Next: palpate improve {} {} --residual -o improved\n", options.model.string(),
                                    options.set.string());
    }
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_diagnose(CLI::App& app) {
    auto* sub = subcommand(app, "diagnose", "Which physical effect the model lacks, with the evidence.",
                           "  palpate diagnose model.json set/\n"
                           "  palpate diagnose model.json set/ --without gravity     # what else would explain it?\n",
                           [this] { return commands::diagnose(diagnose, common); });
    sub->add_option("MODEL", diagnose.model, "model.json")->required();
    sub->add_option("SET", diagnose.set, "The measurements")->required();
    sub->add_option("-o,--output", diagnose.output,
                    "Folder for diagnosis.json, and for what is located or mapped (ParaView)");
    sub->add_option("--without", diagnose.without, "An effect to leave out of the catalogue; repeatable")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    add_body(sub, diagnose.body, "by default");
    add_flag(sub, diagnose.overrides, "volume.edge_length");
    add_flag(sub, diagnose.overrides, "identify.prior");
    for (const char* place : {"diagnose.gravity", "diagnose.false_claims"}) add_flag(sub, diagnose.overrides, place);
}

}  // namespace palpate::pipeline
