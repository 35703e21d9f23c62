#include "pipeline/forge/wish.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/io/words.h"

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

Form form_of(const std::string& wish) {
    const auto colon = wish.find(':');
    if (colon == std::string::npos) return {wish, {}};
    return {wish.substr(0, colon), split(wish.substr(colon + 1), ',')};
}

Wish read_wish(const std::string& text) {
    const Form form = form_of(text);
    Wish wish{form.effect, {}};
    for (const std::string& number : form.numbers) {
        const auto equals = number.find('=');
        const std::string name = number.substr(0, equals), value = number.substr(equals + 1);
        const auto parsed = mesh::parse_number(value);
        if (!parsed) {
            throw InvalidInput(fmt::format("effect '{}': {} is {}, which is no number", form.effect, mesh::cited(name),
                                           mesh::cited(value)));
        }
        if (std::ranges::find(wish.given, name, &skeleton::EffectParameter::name) != wish.given.end()) {
            throw InvalidInput(fmt::format("effect '{}': {} is given twice", form.effect, mesh::cited(name)));
        }
        wish.given.push_back({name, *parsed, ""});
    }
    return wish;
}

}  // namespace

std::string slip_in(const std::string& wish) {
    const Form form = form_of(wish);
    const std::string expected = "; write EFFECT or EFFECT:name=value,name=value, as in gravity:gz=-9810";
    if (form.effect.empty()) return fmt::format("{} names no effect{}", mesh::cited(wish), expected);
    for (const std::string& number : form.numbers) {
        const auto equals = number.find('=');
        if (equals == std::string::npos || equals == 0) {
            return fmt::format("{} in {} is not name=value{}", mesh::cited(number), mesh::cited(wish), expected);
        }
    }
    return {};
}

std::vector<Wish> read_wishes(const std::vector<std::string>& wishes) {
    std::vector<Wish> result;
    for (const std::string& text : wishes) {
        Wish wish = read_wish(text);
        if (std::ranges::find(result, wish.effect, &Wish::effect) != result.end()) {
            throw InvalidInput(
                fmt::format("effect {} is to be hidden twice; once is allowed", mesh::cited(wish.effect)));
        }
        result.push_back(std::move(wish));
    }
    const auto none = std::ranges::find(result, "none", &Wish::effect);
    if (none != result.end() && (result.size() > 1 || !none->given.empty())) {
        throw InvalidInput("'none' hides nothing: it stands alone, without values");
    }
    return result;
}

const Wish* first_with(bool identify::HidingNeeds::*need, const std::vector<Wish>& wishes) {
    const auto found = std::ranges::find_if(wishes, [&](const Wish& wish) {
        const auto known = identify::effect_named(wish.effect);
        return known && known->needs().*need;
    });
    return found == wishes.end() ? nullptr : &*found;
}

std::string to_wish(const skeleton::Effect& effect) {
    std::string text = effect.name;
    for (const auto& [name, value, unit] : effect.parameters) {
        text += fmt::format("{}{}={}", text.size() == effect.name.size() ? ":" : ",", name, value);
    }
    return text;
}

}  // namespace palpate::pipeline
