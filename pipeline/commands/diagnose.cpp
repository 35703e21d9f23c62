#include "identify/diagnose/diagnose.h"

#include <fmt/format.h>

#include "identify/effects/catalogue.h"
#include "mesh/io/atomic_file.h"
#include "pipeline/commands/bodies.h"
#include "pipeline/results/diagnosis_json.h"
#include "pipeline/results/diagnosis_words.h"

namespace palpate::pipeline::commands {

Outcome diagnose(const DiagnoseCommandOptions& options, const Common& common) {
    if (!options.output.empty()) refuse_to_overwrite(options.output, common.force);
    for (const std::string& name : options.without) identify::find_effect(name);
    const ModelAndSet given = read_model_and_set(options.model, options.set);
    identify::DiagnoseOptions how = diagnose_options(given.model, common);
    how.without = options.without;
    const auto body = body_to_judge(options.body, given, options.say.on_defaults().edge_length);
    const identify::Diagnosis found = identify::diagnose(*body, given.set, how, Console::progress());

    Outcome outcome;
    outcome.json = to_json(found, *body, given.set);
    outcome.text = diagnosis_in_words(outcome.json) + "\n";
    for (const std::string& note : found.notes) outcome.text += "  " + note + "\n";
    if (!options.output.empty()) {
        mesh::write_text(options.output / "diagnosis.json", outcome.json.dump(2) + "\n");
        outcome.text += fmt::format("Written: {}\n", (options.output / "diagnosis.json").string());
    }
    if (outcome.json["verdict"] == "missing-effect") {
        outcome.text += fmt::format("Next: palpate improve {} {}", options.model.string(), options.set.string());
        for (const std::string& effect : found.explanation) outcome.text += " --add " + effect;
        outcome.text += options.body == "skeleton" ? " --body skeleton -o improved\n" : " -o improved\n";
    } else if (outcome.json["verdict"] == "ambiguous") {
        outcome.text += "Next: add that probe to the set, and diagnose again\n";
    }
    return outcome;
}

}  // namespace palpate::pipeline::commands
