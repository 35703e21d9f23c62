#include "pipeline/forge/draft.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/io/words.h"
#include "pipeline/forge/drafts/kinds.h"

namespace palpate::pipeline {
namespace {

std::vector<const DraftKind*> all_kinds() {
    std::vector<const DraftKind*> all;
    for (const auto* kinds : {&body_kinds(), &material_kinds(), &placed_kinds(), &measurement_kinds()}) {
        for (const DraftKind& kind : *kinds) all.push_back(&kind);
    }
    return all;
}

/// Null: none of those that can be drawn.
const DraftKind* find_kind(const std::string& name) {
    const auto all = all_kinds();
    const auto found = std::ranges::find(all, name, &DraftKind::name);
    return found == all.end() ? nullptr : *found;
}

std::vector<skeleton::KnownParameter> numbers_of(const DraftKind& kind) {
    return kind.numbers.empty() ? skeleton::find_known_effect(kind.name)->parameters : kind.numbers;
}

/// The known effects in one list; what is spelled nearly like one of them is pointed to.
[[noreturn]] void refuse_unknown(const std::string& name) {
    std::vector<std::string> names{"none"};
    for (const DraftKind* kind : all_kinds()) names.push_back(kind->name);
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
    const DraftKind* kind = find_kind(wish.effect);
    if (!kind) {
        if (!skeleton::find_known_effect(wish.effect)) refuse_unknown(wish.effect);
        skeleton::make_physics(draft_of_own(wish).at(1));
        return;
    }
    std::vector<std::string> names;
    for (const skeleton::KnownParameter& number : numbers_of(*kind)) names.push_back(number.name);
    for (const skeleton::EffectParameter& number : wish.given) {
        if (std::ranges::find(names, number.name) != names.end()) continue;
        throw InvalidInput(fmt::format("effect '{}': {} is not known{}; known are {}", wish.effect,
                                       mesh::cited(number.name), mesh::suggestion(number.name, names),
                                       mesh::listed(names)));
    }
}

std::vector<Draft> drafts_of(const Specimen& specimen, const Plan& plan, const Wish& wish, const Rhythm& rhythm,
                             std::uint64_t seed) {
    const DraftKind* kind = find_kind(wish.effect);
    if (!kind) return {draft_of_own(wish)};
    // Each effect draws from a stream of its own, so that others beside it change nothing.
    const auto all = all_kinds();
    const auto place = static_cast<std::uint64_t>(std::ranges::find(all, kind) - all.begin());
    constexpr std::uint64_t apart = 1'000'000;  // from the streams of the readings
    Drawing drawing{specimen, plan, wish, rhythm, identify::RandomStream(seed, apart + place, 0)};
    return kind->draw(drawing, Told(wish, numbers_of(*kind)));
}

Vec3 random_direction(identify::RandomStream& random) {
    Vec3 direction;
    do {
        direction = random.normals(3);
    } while (direction.norm() < 1e-6);
    return direction.normalized();
}

}  // namespace palpate::pipeline
