#include "pipeline/synthesis/effects/effect_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::pipeline {
namespace {

/// The effect of that name that draws its numbers; null: there is none.
std::shared_ptr<const identify::EffectHypothesis> drawn_effect(const std::string& name) {
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
    names.insert(names.begin(), no_effect);
    throw InvalidInput(fmt::format("effect {} is not known{}; known are {}", mesh::cited(name),
                                   mesh::suggestion(name, names), mesh::listed(names)));
}

/// A user-defined effect: a single number that is not specified is its strength; otherwise all must be specified.
EffectSampler sampler_of_own(const EffectSpec& spec) {
    skeleton::EffectRecord effect{spec.effect, spec.given};
    std::vector<skeleton::KnownParameter> unspecified;
    for (const skeleton::KnownParameter& known : skeleton::find_known_effect(spec.effect)->parameters) {
        const bool is_specified =
            std::ranges::find(spec.given, known.name, &skeleton::EffectParameter::name) != spec.given.end();
        if (!is_specified && !known.optional) unspecified.push_back(known);
    }
    if (unspecified.size() != 1) {
        skeleton::make_physics(effect);  // refuses an incomplete specification
        return {.at = [effect](double) { return effect; }, .is_specified = true};
    }
    effect.parameters.push_back({unspecified[0].name, 1, unspecified[0].unit});
    return {.at = [effect](double x) {
        skeleton::EffectRecord stronger = effect;
        stronger.parameters.back().value = x;
        return stronger;
    }};
}

}  // namespace

void check_spec(const EffectSpec& spec) {
    const auto effect = drawn_effect(spec.effect);
    if (!effect) {
        if (!skeleton::find_known_effect(spec.effect)) refuse_unknown(spec.effect);
        skeleton::make_physics(sampler_of_own(spec).at(1));
        return;
    }
    std::vector<std::string> names;
    for (const skeleton::KnownParameter& number : effect->numbers_to_hide()) names.push_back(number.name);
    for (const skeleton::EffectParameter& number : spec.given) {
        if (std::ranges::find(names, number.name) != names.end()) continue;
        throw InvalidInput(fmt::format("effect '{}': {} is not known{}; known are {}", spec.effect,
                                       mesh::cited(number.name), mesh::suggestion(number.name, names),
                                       mesh::listed(names)));
    }
}

std::vector<EffectSampler> samplers_of(const Specimen& specimen, const Plan& plan, const EffectSpec& spec,
                                       const LoadTiming& timing, std::uint64_t seed, int which) {
    const auto effect = drawn_effect(spec.effect);
    if (!effect) return {sampler_of_own(spec)};
    // Each effect draws from a stream of its own, so that others beside it change nothing.
    constexpr std::uint64_t apart = 1'000'000;  // from the streams of the readings
    std::optional<double> poisson;
    if (specimen.material) poisson = specimen.material->poisson;
    identify::SamplingContext context{
        .model = *specimen.model,
        .setting = specimen.setting,
        .set = specimen.set,
        .stiffness = specimen.stiffness,
        .poisson = poisson,
        .dwell = timing.dwell,
        .baseline = plan.baseline,
        .random = identify::RandomStream(seed, apart + *effect->stream(), static_cast<std::uint64_t>(which)),
    };
    return effect->samplers(context, {spec.effect, spec.given, effect->numbers_to_hide()});
}

}  // namespace palpate::pipeline
