#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "pipeline/case/settings/names.h"
#include "pipeline/case/settings/settings.h"

// What a row of settings.cpp is written with: a kind of value each, by its place in case.yaml, what it is, and the
// member of a case that holds it. `member` takes a case, const or not, to a reference.

namespace palpate::pipeline::declare {

struct Range {
    double least, most;
};

/// A setting without a value yet; of the stage that its section is named for.
CaseSetting declared(std::string_view place, std::string help);

/// A flag of its own name for it: --edge-length for volume.edge_length.
CaseSetting with_flag(std::string group, CaseSetting setting);

CaseSetting of_stage(std::string stage, CaseSetting setting);

template <typename T>
struct Unwrapped {
    using type = T;
};
template <typename T>
struct Unwrapped<std::optional<T>> {
    using type = T;
};

template <typename T>
constexpr bool is_optional = !std::is_same_v<T, typename Unwrapped<T>::type>;

/// The type of what `member` names in a case.
template <typename Member>
using Held = std::remove_cvref_t<std::invoke_result_t<Member, Case&>>;

template <typename Member>
nlohmann::json value_of(Member member, const Case& c) {
    const auto& held = member(c);
    if constexpr (is_optional<std::remove_cvref_t<decltype(held)>>)
        return held ? nlohmann::json(*held) : nlohmann::json();
    else
        return held;
}

/// A number, or a whole number, as its member in the case is.
template <typename Member>
CaseSetting number(std::string_view place, std::string help, Range range, Member member) {
    using Number = typename Unwrapped<Held<Member>>::type;
    CaseSetting setting = declared(place, std::move(help));
    if constexpr (std::is_integral_v<Number>) {
        const int least = static_cast<int>(range.least), most = static_cast<int>(range.most);
        setting.schema = {{"type", "integer"}, {"minimum", least}, {"maximum", most}};
        setting.read = [key = setting.key, least, most, member](const mesh::YamlFields& yaml, Case& c) {
            member(c) = static_cast<Number>(yaml.integer(key, least, most));
        };
    } else {
        setting.schema = {{"type", "number"}, {"minimum", range.least}, {"maximum", range.most}};
        setting.read = [key = setting.key, range, member](const mesh::YamlFields& yaml, Case& c) {
            member(c) = yaml.number(key, range.least, range.most);
        };
    }
    setting.value = [member](const Case& c) { return value_of(member, c); };
    return setting;
}

template <typename Member>
CaseSetting yes_or_no(std::string_view place, std::string help, Member member) {
    CaseSetting setting = declared(place, std::move(help));
    setting.schema = {{"type", "boolean"}};
    setting.read = [key = setting.key, member](const mesh::YamlFields& yaml, Case& c) {
        member(c) = yaml.boolean(key);
    };
    setting.value = [member](const Case& c) { return nlohmann::json(member(c)); };
    return setting;
}

template <typename Enum, std::size_t N>
std::vector<std::string> words_of(const Names<Enum, N>& names) {
    std::vector<std::string> words;
    for (const auto& [name, value] : names) words.emplace_back(name);
    return words;
}

template <typename Enum, std::size_t N, typename Member>
CaseSetting choice(std::string_view place, std::string help, const Names<Enum, N>& names, Member member) {
    CaseSetting setting = declared(place, std::move(help));
    setting.schema = {{"enum", words_of(names)}};
    setting.read = [key = setting.key, &names, member](const mesh::YamlFields& yaml, Case& c) {
        member(c) = parse(names, yaml.text(key), yaml.where(key));
    };
    setting.value = [&names, member](const Case& c) { return nlohmann::json(name_of(names, member(c))); };
    return setting;
}

/// Several of these names.
template <typename Enum, std::size_t N, typename Member>
CaseSetting choices(std::string_view place, std::string help, const Names<Enum, N>& names, Member member) {
    CaseSetting setting = declared(place, std::move(help));
    setting.schema = {{"type", "array"}, {"items", {{"enum", words_of(names)}}}};
    setting.flag_is_repeatable = true;
    setting.read = [key = setting.key, &names, member](const mesh::YamlFields& yaml, Case& c) {
        member(c).clear();
        for (const std::string& name : yaml.texts(key)) member(c).push_back(parse(names, name, yaml.where(key)));
    };
    setting.value = [&names, member](const Case& c) {
        nlohmann::json words = nlohmann::json::array();
        for (const Enum one : member(c)) words.push_back(name_of(names, one));
        return words;
    };
    return setting;
}

template <typename Member>
CaseSetting texts(std::string_view place, std::string help, Member member) {
    CaseSetting setting = declared(place, std::move(help));
    setting.schema = {{"type", "array"}, {"items", {{"type", "string"}}}};
    setting.read = [key = setting.key, member](const mesh::YamlFields& yaml, Case& c) { member(c) = yaml.texts(key); };
    setting.value = [member](const Case& c) { return value_of(member, c); };
    return setting;
}

}  // namespace palpate::pipeline::declare
