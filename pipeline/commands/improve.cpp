#include <fmt/format.h>

#include "identify/diagnose/ladder.h"
#include "identify/effects/catalogue.h"
#include "pipeline/commands/bodies.h"
#include "pipeline/results/diagnosis_json.h"
#include "pipeline/results/diagnosis_words.h"
#include "pipeline/results/ladder.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

identify::IdentifyOptions identify_options(const CaseOverrides& say, const Common& common) {
    identify::IdentifyOptions how = say.on_defaults().identify;
    how.seed = common.seed.value_or(how.seed);
    how.threads = common.threads;
    return how;
}

/// A diagnosis, said aloud.
identify::Diagnosis diagnose_aloud(const identify::BodyModel& body, const identify::MeasurementSet& set,
                                   const identify::DiagnoseOptions& how) {
    identify::Diagnosis found = identify::diagnose(body, set, how, Console::progress());
    Console::notice(diagnosis_in_words(to_json(found, body, set)));
    if (found.explanation.empty()) Console::notice("Nothing is added.");
    return found;
}

/// "reference" or "skeleton".
std::string judged_on(const ImproveCommandOptions& options) {
    std::string of_links;
    for (const std::string& name : options.add) {
        if (identify::find_effect(name)->is_of_links()) of_links = name;
    }
    if (!options.body.empty()) return options.body;
    if (of_links.empty()) return "reference";
    Console::notice(fmt::format("Errors are judged on the skeleton: no solid has '{}'.", of_links));
    return "skeleton";
}

}  // namespace

Outcome improve(const ImproveCommandOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("improved") : options.output;
    refuse_to_overwrite(output, common.force);
    const std::string kind = judged_on(options);
    const ModelAndSet given = read_model_and_set(options.model, options.set);
    const identify::LadderOptions how{.identify = identify_options(options.say, common),
                                      .diagnose = diagnose_options(given.model, common),
                                      .only_better = options.automatic};
    how.identify.validate();
    const auto body = body_to_judge(kind, given, options.say.on_defaults().edge_length);
    std::optional<identify::Diagnosis> found;
    if (options.automatic) found = diagnose_aloud(*body, given.set, how.diagnose);
    const std::vector<std::string>& effects = found ? found->explanation : options.add;
    identify::Ladder ladder =
        identify::climb(given.model, *body, given.set, effects, how, found ? &*found : nullptr, Console::progress());
    ladder.identified.damping = damping_of(ladder.steps.back().model, given.set, how.identify.seed, common);
    write_ladder(output, ladder);

    Outcome outcome;
    outcome.json = to_json(ladder);
    outcome.json["model"] = (output / "model.json").string();
    outcome.text = ladder_in_words(outcome.json);
    for (const std::string& note : ladder.notes) outcome.text += "  " + note + "\n";
    outcome.text +=
        fmt::format("Model: {}\nParaView: {}\n", (output / "model.json").string(), (output / "ladder.pvd").string());
    outcome.text +=
        outcome.json["verdict"] == "adequate"
            ? fmt::format("Next: palpate simulate {} --probes probes.csv -o played\n", (output / "model.json").string())
            : fmt::format("Next: palpate diagnose {} {}\n", (output / "model.json").string(), options.set.string());
    return outcome;
}

}  // namespace palpate::pipeline::commands
