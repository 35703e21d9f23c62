#include <fmt/format.h>

#include <algorithm>

#include "pipeline/case/settings/settings.h"

// Settings as text: lines of case.yaml, as a run leaves them and as a user edits them, and JSON schemas.

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::string yaml_of(const json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_array()) {
        std::vector<std::string> items;
        for (const json& item : value) items.push_back(yaml_of(item));
        return fmt::format("[{}]", fmt::join(items, ", "));
    }
    return value.is_number_float() ? fmt::format("{}", value.get<double>()) : value.dump();
}

constexpr std::size_t comment_column = 30;  // beyond most settings with their values

/// "(full, burion2008)" where there is a choice.
std::string choice_in_words(const ordered_json& schema) {
    if (schema.value("type", "") == "array") return choice_in_words(schema["items"]);
    if (!schema.contains("enum")) return {};
    return fmt::format(" ({})", fmt::join(schema["enum"].get<std::vector<std::string>>(), ", "));
}

std::string line(const std::string& indent, const CaseSetting& setting, const std::string& value) {
    return fmt::format("{:<{}} # {}{}\n", fmt::format("{}{}: {}", indent, setting.key, value), comment_column - 1,
                       setting.help, choice_in_words(setting.schema));
}

}  // namespace

std::string setting_yaml(const Case& c, const CaseSetting& setting) {
    const json value = setting.value(c);
    return value.is_null() ? "" : line(setting.section.empty() ? "" : "  ", setting, yaml_of(value));
}

std::string section_yaml(const Case& c, const std::string& section) {
    std::string text;
    for (const CaseSetting& setting : settings())
        if (setting.section == section) text += setting_yaml(c, setting);
    return text.empty() ? text : section + ":\n" + text;
}

std::string example_yaml(const CaseSetting& setting, const std::vector<Example>& examples) {
    const std::string indent = setting.section.empty() ? "" : "  ";
    const auto given = std::ranges::find(examples, setting.place(), &Example::place);
    if (given != examples.end()) return line(indent, setting, std::string(given->value));
    const json value = setting.value(Case{});
    return line("# " + indent, setting, value.is_null() ? "" : yaml_of(value));
}

std::string example_section_yaml(const std::string& section, const std::vector<Example>& examples) {
    std::string text;
    bool is_commented = true;
    for (const CaseSetting& setting : settings()) {
        if (setting.section != section) continue;
        text += example_yaml(setting, examples);
        if (std::ranges::find(examples, setting.place(), &Example::place) != examples.end()) is_commented = false;
    }
    return (is_commented ? "# " : "") + section + ":\n" + text;
}

ordered_json schema_of(const CaseSetting& setting) {
    ordered_json schema{{"description", setting.help}};
    schema.update(setting.schema);
    const json value = setting.value(Case{});
    if (!value.is_null()) schema["default"] = value;
    return schema;
}

}  // namespace palpate::pipeline
