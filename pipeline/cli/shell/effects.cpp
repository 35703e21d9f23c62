#include <fmt/format.h>

#include "identify/effects/catalogue.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"

namespace palpate::pipeline::commands {
namespace {

using nlohmann::json;

json effect_json(const identify::EffectHypothesis& effect) {
    const identify::EffectDescription& text = effect.description();
    return {{"effect", text.name},
            {"kind", fem::kind_name(text.kind)},
            {"meaning", text.meaning},
            {"parameters", text.parameters},
            {"reveals", text.reveals},
            {"confused_with", text.confused_with},
            {"separating_probe", text.separating_probe},
            {"next_probe", text.next_probe}};
}

std::string in_full(const identify::EffectHypothesis& effect) {
    const identify::EffectDescription& text = effect.description();
    std::string parameters;
    for (const std::string& parameter : text.parameters) parameters += "  " + parameter + "\n";
    return fmt::format("{}: {}\n{}\n{}\nRevealed by {}.\nConfused with {}.\nTo distinguish them: {}.\n", text.name,
                       effect.is_of_body() ? "a property of the body" : "a fault of the measurement", text.meaning,
                       parameters, text.reveals, fmt::join(text.confused_with, ", "), text.separating_probe);
}

}  // namespace

Outcome effects(const EffectsOptions& options, const Common&) {
    if (!options.name.empty()) {
        const auto effect = identify::find_effect(options.name);
        return {.text = in_full(*effect), .json = effect_json(*effect)};
    }
    Outcome outcome;
    outcome.json = {{"effects", json::array()}};
    for (const auto& effect : identify::all_effects()) {
        outcome.text += fmt::format("{:<18} {:<12} {}\n", effect->name(), fem::kind_name(effect->description().kind),
                                    effect->description().meaning);
        outcome.json["effects"].push_back(effect_json(*effect));
    }
    outcome.text += "\npalpate effects NAME describes one in full.\n";
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_effects(CLI::App& app) {
    auto* sub = subcommand(app, "effects", "The catalogue of effects that a model may lack.",
                           "  palpate effects\n  palpate effects gravity\n",
                           [this] { return commands::effects(effects, common); });
    sub->add_option("NAME", effects.name, "One effect in full");
}

}  // namespace palpate::pipeline
