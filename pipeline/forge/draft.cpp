#include "pipeline/forge/draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/io/words.h"

namespace palpate::pipeline {
namespace {

/// The effect of that name that draws its numbers; null: there is none.
std::shared_ptr<const identify::Effect> drawn_effect(const std::string& name) {
    auto effect = identify::effect_named(name);
    return effect && effect->stream() ? effect : nullptr;
}

/// Effects that draw their numbers, in the order of their streams.
std::vector<std::string> drawn_effects() {
    std::multimap<std::uint64_t, std::string> by_stream;
    for (const auto& effect : identify::catalogue()) {
        if (effect->stream()) by_stream.emplace(*effect->stream(), effect->name());
    }
    std::vector<std::string> names;
    for (const auto& entry : by_stream) names.push_back(entry.second);
    return names;
}

/// The known effects in one list; what is spelled nearly like one of them is pointed to.
[[noreturn]] void refuse_unknown(const std::string& name) {
    std::vector<std::string> names = drawn_effects();
    names.insert(names.begin(), "none");
    throw InvalidInput(fmt::format("effect {} is not known{}; known are {}", mesh::cited(name),
                                   mesh::suggestion(name, names), mesh::listed(names)));
}

/// An effect that a user made known: if it lacks one number, that is how strong it is; else it is all told.
Draft draft_of_own(const Wish& wish) {
    skeleton::Effect effect{wish.effect, wish.given};
    std::vector<skeleton::KnownParameter> untold;
    for (const skeleton::KnownParameter& known : skeleton::find_known_effect(wish.effect)->parameters) {
        const bool is_told =
            std::ranges::find(wish.given, known.name, &skeleton::EffectParameter::name) != wish.given.end();
        if (!is_told && !known.optional) untold.push_back(known);
    }
    if (untold.size() != 1) {
        skeleton::make_physics(effect);  // refuses what is not complete
        return {.at = [effect](double) { return effect; }, .is_told = true};
    }
    effect.parameters.push_back({untold[0].name, 1, untold[0].unit});
    return {.at = [effect](double x) {
        skeleton::Effect stronger = effect;
        stronger.parameters.back().value = x;
        return stronger;
    }};
}

}  // namespace

void check_wish(const Wish& wish) {
    const auto effect = drawn_effect(wish.effect);
    if (!effect) {
        if (!skeleton::find_known_effect(wish.effect)) refuse_unknown(wish.effect);
        skeleton::make_physics(draft_of_own(wish).at(1));
        return;
    }
    std::vector<std::string> names;
    for (const skeleton::KnownParameter& number : effect->numbers_to_hide()) names.push_back(number.name);
    for (const skeleton::EffectParameter& number : wish.given) {
        if (std::ranges::find(names, number.name) != names.end()) continue;
        throw InvalidInput(fmt::format("effect '{}': {} is not known{}; known are {}", wish.effect,
                                       mesh::cited(number.name), mesh::suggestion(number.name, names),
                                       mesh::listed(names)));
    }
}

std::vector<Draft> drafts_of(const Specimen& specimen, const Plan& plan, const Wish& wish, const Rhythm& rhythm,
                             std::uint64_t seed) {
    const auto effect = drawn_effect(wish.effect);
    if (!effect) return {draft_of_own(wish)};
    // Each effect draws from a stream of its own, so that others beside it change nothing.
    constexpr std::uint64_t apart = 1'000'000;  // from the streams of the readings
    std::optional<double> poisson;
    if (specimen.material) poisson = specimen.material->poisson;
    identify::Drawing drawing{
        .model = *specimen.model,
        .setting = specimen.setting,
        .set = specimen.set,
        .stiffness = specimen.stiffness,
        .poisson = poisson,
        .dwell = rhythm.dwell,
        .bare = plan.bare,
        .random = identify::RandomStream(seed, apart + *effect->stream(), 0),
    };
    return effect->drafts(drawing, {wish.effect, wish.given, effect->numbers_to_hide()});
}

}  // namespace palpate::pipeline
