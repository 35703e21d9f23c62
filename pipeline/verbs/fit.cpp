#include "pipeline/verbs/flags.h"
#include "pipeline/verbs/verbs.h"

// Verbs that work on a model and measurements.

namespace palpate::pipeline {

void Verbs::add_identify(CLI::App& app) {
    auto* sub = verb(app, "identify", "Stiffness per link by particle filter.",
                     "  palpate identify model.json set/ -o fitted --parameters zones\n",
                     [this] { return commands::identify(identify, common); });
    sub->add_option("MODEL", identify.model, "model.json")->required();
    sub->add_option("SET", identify.set, "The measurements")->required();
    sub->add_option("-o,--output", identify.output,
                    "Folder for model.json, posterior.csv, history.pvd; identified by default");
    add_flags_of(sub, identify.say, "Identification");
}

void Verbs::add_compare(CLI::App& app) {
    auto* sub = verb(
        app, "compare", "Model against measurements: how wrong, where, under which probe.",
        "  palpate compare model.json set/\n  palpate compare model.json set/ --tolerance 0.5 && echo good enough\n"
        "  palpate compare model.json set/ --no-reference     # the skeleton alone: fast\n",
        [this] { return commands::compare(compare, common); });
    sub->add_option("MODEL", compare.model, "model.json")->required();
    sub->add_option("SET", compare.set, "The measurements")->required();
    sub->add_option("-o,--output", compare.output, "Folder for compare.json and the .vtp series");
    sub->add_option("--tolerance", compare.tolerance, "Exit code 5 where the rms error is larger [mm]")
        ->check(CLI::NonNegativeNumber);
    sub->add_flag("--no-reference", compare.no_reference,
                  "Leave the body in finite elements out: fast, but without an error budget");
    add_flag(sub, compare.say, "volume.edge_length");
}

void Verbs::add_diagnose(CLI::App& app) {
    auto* sub = verb(app, "diagnose", "Which physical effect the model lacks, with the evidence.",
                     "  palpate diagnose model.json set/\n"
                     "  palpate diagnose model.json set/ --without gravity     # what else would explain it?\n",
                     [this] { return commands::diagnose(diagnose, common); });
    sub->add_option("MODEL", diagnose.model, "model.json")->required();
    sub->add_option("SET", diagnose.set, "The measurements")->required();
    sub->add_option("-o,--output", diagnose.output, "Folder for diagnosis.json");
    sub->add_option("--without", diagnose.without, "An effect to leave out of the catalogue; repeatable")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    add_body(sub, diagnose.body, "by default");
    add_flag(sub, diagnose.say, "volume.edge_length");
}

void Verbs::add_improve(CLI::App& app) {
    auto* sub = verb(app, "improve", "Adds an effect, fits anew, and shows the error before and after.",
                     "  palpate improve model.json set/ --auto -o improved\n"
                     "  palpate improve model.json set/ --add gravity --add misalignment -o improved\n",
                     [this] { return commands::improve(improve, common); });
    sub->add_option("MODEL", improve.model, "model.json")->required();
    sub->add_option("SET", improve.set, "The measurements")->required();
    sub->add_option("-o,--output", improve.output,
                    "Folder for model.json, ladder.json, ladder.pvd; improved by default");
    auto* what = sub->add_option_group("What to add", "one of these");
    what->add_option("--add", improve.add, "An effect ('palpate effects' lists them); repeatable, a step each")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    what->add_flag("--auto", improve.automatic, "What a diagnosis names");
    what->require_option(1);
    add_body(sub, improve.body, "by default, but for what links alone have");
    add_flags_of(sub, improve.say, "Identification");
    add_flag(sub, improve.say, "volume.edge_length");
}

void Verbs::add_effects(CLI::App& app) {
    auto* sub =
        verb(app, "effects", "The catalogue of effects that a model may lack.",
             "  palpate effects\n  palpate effects gravity\n", [this] { return commands::effects(effects, common); });
    sub->add_option("NAME", effects.name, "One effect in full");
}

}  // namespace palpate::pipeline
