#include "pipeline/synthesis/effects/effect_spec.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::pipeline {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == at) {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

struct Form {
    std::string effect;
    std::vector<std::string> numbers;  // "name=value" each
};

Form form_of(const std::string& spec) {
    const auto colon = spec.find(':');
    if (colon == std::string::npos) return {spec, {}};
    return {spec.substr(0, colon), split(spec.substr(colon + 1), ',')};
}

EffectSpec read_effect_spec(const std::string& text) {
    const Form form = form_of(text);
    EffectSpec spec{form.effect, {}};
    for (const std::string& number : form.numbers) {
        const auto equals = number.find('=');
        const std::string name = number.substr(0, equals), value = number.substr(equals + 1);
        const auto parsed = mesh::parse_number(value);
        if (!parsed) {
            throw InvalidInput(fmt::format("effect '{}': {} is {}, which is no number", form.effect, mesh::cited(name),
                                           mesh::cited(value)));
        }
        if (std::ranges::find(spec.given, name, &skeleton::EffectParameter::name) != spec.given.end()) {
            throw InvalidInput(fmt::format("effect '{}': {} is given twice", form.effect, mesh::cited(name)));
        }
        spec.given.push_back({name, *parsed, ""});
    }
    return spec;
}

}  // namespace

std::string objection_to_spec(const std::string& spec) {
    const Form form = form_of(spec);
    const std::string expected = "; write EFFECT or EFFECT:name=value,name=value, as in gravity:gz=-9810";
    if (form.effect.empty()) return fmt::format("{} names no effect{}", mesh::cited(spec), expected);
    for (const std::string& number : form.numbers) {
        const auto equals = number.find('=');
        if (equals == std::string::npos || equals == 0) {
            return fmt::format("{} in {} is not name=value{}", mesh::cited(number), mesh::cited(spec), expected);
        }
    }
    return {};
}

std::vector<EffectSpec> read_specs(const std::vector<std::string>& specs) {
    std::vector<EffectSpec> result;
    for (const std::string& text : specs) {
        EffectSpec spec = read_effect_spec(text);
        const auto effect = identify::effect_named(spec.effect);
        const bool may_repeat = effect && effect->may_repeat();
        if (!may_repeat && std::ranges::find(result, spec.effect, &EffectSpec::effect) != result.end())
            throw InvalidInput(fmt::format("effect {} stands there twice; a body has it once. Leave one out.",
                                           mesh::cited(spec.effect)));
        result.push_back(std::move(spec));
    }
    const auto none = std::ranges::find(result, no_effect, &EffectSpec::effect);
    if (none != result.end() && (result.size() > 1 || !none->given.empty())) {
        throw InvalidInput(fmt::format("'{}' hides nothing: it stands alone, without values", no_effect));
    }
    return result;
}

const EffectSpec* first_with(bool identify::SynthesisNeeds::*need, const std::vector<EffectSpec>& specs) {
    const auto found = std::ranges::find_if(specs, [&](const EffectSpec& spec) {
        const auto known = identify::effect_named(spec.effect);
        return known && known->needs().*need;
    });
    return found == specs.end() ? nullptr : &*found;
}

std::string to_spec(const skeleton::EffectRecord& effect) {
    std::string text = effect.name;
    for (const auto& [name, value, unit] : effect.parameters) {
        text += fmt::format("{}{}={}", text.size() == effect.name.size() ? ":" : ",", name, value);
    }
    return text;
}

}  // namespace palpate::pipeline
