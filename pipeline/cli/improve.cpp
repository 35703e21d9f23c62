#include <fmt/format.h>

#include <fmt/ranges.h>
#include <algorithm>

#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/ladder/ladder.h"
#include "identify/diagnosis/locate/residual.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/json/diagnosis.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/text/draft.h"
#include "pipeline/run/inputs/model_and_set.h"
#include "pipeline/synthesis/effects/effect_spec.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

identify::IdentifyOptions identify_options(const CaseOverrides& overrides, const Common& common) {
    identify::IdentifyOptions how = overrides.on_defaults().identify;
    how.seed = common.seed.value_or(how.seed);
    how.threads = common.threads;
    return how;
}

/// A diagnosis, said aloud.
identify::Diagnosis diagnose_aloud(const identify::BodyModel& body, const identify::MeasurementSet& set,
                                   const identify::DiagnoseOptions& how) {
    identify::Diagnosis found = identify::diagnose(body, set, how, Console::progress());
    Console::notice(diagnosis_in_words(to_json(found, body, set)));
    if (found.explanation.empty()) Console::notice("Nothing that has a name is added.");
    return found;
}

/// What is left by then, as an effect that both models show.
std::optional<identify::Residual> find_residual_aloud(const identify::BodyModel& body, const identify::Diagnosis& found,
                                                      const identify::DiagnoseOptions& options) {
    if (found.verdict != identify::Verdict::unexplained) {
        Console::notice("What is left is noise: there is no residual to add.");
        return std::nullopt;
    }
    std::optional<identify::Residual> residual = identify::find_residual(body, found, options);
    if (!residual) {
        Console::notice(
            "No residual is added: what is left is no constant force, no spring, no growth and no change of stiffness "
            "in "
            "one place, which models could show without knowing its cause.");
        return std::nullopt;
    }
    Console::notice(fmt::format("What is left, located: {} (ln Bayes factor {:.3g})",
                                identify::find_effect(residual->effect.name)->sentence(residual->effect),
                                residual->log_bayes_factor));
    return residual;
}

/// Effects with the numbers that a fit is to begin with.
std::vector<skeleton::EffectRecord> starts_of(const std::vector<std::string>& specs) {
    std::vector<skeleton::EffectRecord> starts;
    for (const EffectSpec& spec : read_specs(specs)) {
        const auto& parameters = identify::find_effect(spec.effect)->description().parameters;
        for (const skeleton::EffectParameter& given : spec.given) {
            const auto names = [&](const std::string& words) {
                return fmt::format(", {},", words.substr(0, words.find(" ["))).find(", " + given.name + ",") !=
                       std::string::npos;
            };
            if (std::ranges::none_of(parameters, names))
                throw InvalidInput(fmt::format("effect '{}' has no number {}; it has {}", spec.effect,
                                               mesh::cited(given.name), fmt::join(parameters, "; ")));
        }
        starts.push_back({spec.effect, spec.given});
    }
    for (const skeleton::EffectRecord& start : starts)
        if (start.parameters.empty() && std::ranges::count(starts, start.name, &skeleton::EffectRecord::name) > 1)
            throw InvalidInput(fmt::format(
                "effect '{0}' is to be added several times, and nothing tells one from the other. Say where "
                "each is ({1}), or use --auto, which finds them.",
                start.name, fmt::join(identify::find_effect(start.name)->description().parameters, "; ")));
    return starts;
}

std::vector<std::string> names_of(const std::vector<skeleton::EffectRecord>& effects) {
    std::vector<std::string> names(effects.size());
    std::ranges::transform(effects, names.begin(), &skeleton::EffectRecord::name);
    return names;
}

/// "reference" or "skeleton".
std::string judged_on(const ImproveCommandOptions& options, const std::vector<std::string>& effects) {
    std::string of_links;
    for (const std::string& name : effects) {
        if (identify::find_effect(name)->is_of_links()) of_links = name;
    }
    if (!options.body.empty()) return options.body;
    if (of_links.empty()) return "reference";
    Console::notice(fmt::format("Errors are judged on the skeleton: no solid has '{}'.", of_links));
    return "skeleton";
}

/// The one of them that no catalogue has a name for.
std::optional<skeleton::EffectRecord> unnamed_among(const std::vector<skeleton::EffectRecord>& effects) {
    for (const skeleton::EffectRecord& effect : effects)
        for (const auto& unnamed : identify::unnamed_sources())
            if (unnamed->name() == effect.name) return effect;
    return std::nullopt;
}

}  // namespace

Improved improve(const ModelAndSet& given, const ImproveCommandOptions& options, const Common& common) {
    const std::vector<skeleton::EffectRecord> starts = starts_of(options.add);
    std::vector<std::string> effects = names_of(starts);
    const bool is_diagnosed = options.automatic || options.residual;
    identify::LadderOptions how{.identify = identify_options(options.overrides, common),
                                .diagnose = diagnose_options(options.overrides.on_defaults().diagnose,
                                                             given.set.density.has_value(), given.model, common),
                                .only_better = is_diagnosed,
                                .start = starts};
    how.identify.validate();
    auto body = body_to_diagnose(judged_on(options, effects), given, options.overrides.on_defaults());
    std::optional<identify::Diagnosis> found;
    if (is_diagnosed) {
        found = diagnose_aloud(*body, given.set, how.diagnose);
        effects = found->explanation;
    }
    if (options.residual) {
        how.residual = find_residual_aloud(*body, *found, how.diagnose);
        if (how.residual) effects.push_back(how.residual->effect.name);
    }
    identify::Ladder ladder = identify::build_ladder(given.model, *body, given.set, effects, how,
                                                     found ? &*found : nullptr, Console::progress());
    ladder.identified.damping = damping_of(ladder.steps.back().model, given.set, how.identify.seed, common);
    return {std::move(ladder), std::move(body)};
}

Outcome improve(const ImproveCommandOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("improved") : options.output;
    refuse_to_overwrite(output, common.force);
    starts_of(options.add);  // refuses what is no effect before anything is read
    if (!options.draft.empty()) {
        refuse_to_overwrite(options.draft, common.force);
        check_draft_name(options.draft.stem().string());
    }
    const ModelAndSet given = read_model_and_set(options.model, options.set);
    const auto [ladder, body] = improve(given, options, common);
    write_ladder(output, ladder, *body);

    const std::optional<skeleton::EffectRecord> drafted = unnamed_among(ladder.steps.back().effects);
    if (!options.draft.empty() && drafted)
        mesh::write_text(options.draft, draft_of(*drafted, options.draft.stem().string()));

    Outcome outcome;
    outcome.json = to_json(ladder);
    outcome.json["model"] = (output / "model.json").string();
    outcome.text = ladder_in_words(outcome.json);
    outcome.text +=
        compare_in_words(final_comparison(ladder, *body), "The real-time model, fitted to all probes,") + "\n";
    for (const std::string& note : ladder.notes) outcome.text += "  " + note + "\n";
    outcome.text +=
        fmt::format("Model: {}\nParaView: {}\n", (output / "model.json").string(), (output / "ladder.pvd").string());
    if (!options.draft.empty()) {
        outcome.json["draft"] = drafted ? nlohmann::json(options.draft.string()) : nlohmann::json();
        outcome.text += drafted ? fmt::format("Draft of an effect: {}\n", options.draft.string())
                                : "No draft is written: nothing without a name was added.\n";
    }
    outcome.text +=
        outcome.json["verdict"] == "adequate"
            ? fmt::format("Next: {}\n", command_to_play(output / "model.json", given.set))
            : fmt::format("Next: palpate diagnose {} {}\n", (output / "model.json").string(), options.set.string());
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_improve(CLI::App& app) {
    auto* sub = subcommand(app, "improve", "Adds an effect, fits anew, and shows the error before and after.",
                           "  palpate improve model.json set/ --auto -o improved\n"
                           "  palpate improve model.json set/ --add gravity --add misalignment -o improved\n",
                           [this] { return commands::improve(improve, common); });
    sub->add_option("MODEL", improve.model, "model.json")->required();
    sub->add_option("SET", improve.set, "The measurements")->required();
    sub->add_option("-o,--output", improve.output,
                    "Folder for model.json, ladder.json, ladder.pvd; improved by default");
    auto* what = sub->add_option_group("What to add", "one of these");
    what->add_option("--add", improve.add,
                     "An effect ('palpate effects' lists them), EFFECT[:name=value,...]; repeatable, a step each. Its\n"
                     "numbers are fitted; values are where the fit begins: gravity:gz=-9810")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(CLI::Validator([](std::string& spec) { return objection_to_spec(spec); }, "EFFECT[:name=value,...]"));
    what->add_flag("--auto", improve.automatic, "What a diagnosis names");
    what->add_flag(
        "--residual", improve.residual,
        "What a diagnosis names or, where no effect explains the measurements, a force, springs, growth or another\n"
        "stiffness in one place, whatever its cause, if the forecast of held-out probes gains by it");
    what->require_option(1);
    sub->add_option(
           "--draft", improve.draft,
           "Write what --residual adds as a C++ file, to develop an effect of your own from; the name of the file\n"
           "is that of the effect")
        ->type_name("PATH")
        ->needs("--residual");
    add_body(sub, improve.body, "by default, but for what links alone have");
    add_flags_of(sub, improve.overrides, "Identification");
    add_flag(sub, improve.overrides, "volume.edge_length");
    for (const char* place : {"diagnose.gravity", "diagnose.false_claims"}) add_flag(sub, improve.overrides, place);
}

}  // namespace palpate::pipeline
