#include "pipeline/command_line/flags.h"

#include <fmt/format.h>

#include <stdexcept>

#include "mesh/text/words.h"
#include "pipeline/case/settings/settings.h"

namespace palpate::pipeline {
namespace {

bool is_path(const nlohmann::ordered_json& schema) { return schema.value("type", "") == "string"; }

/// "{full,burion2008}", or the type and its bounds.
std::string type_in_words(const nlohmann::ordered_json& schema) {
    if (schema.value("type", "") == "array") return type_in_words(schema["items"]);
    if (is_path(schema)) return "PATH";
    if (schema.contains("enum"))
        return fmt::format("{{{}}}", fmt::join(schema["enum"].get<std::vector<std::string>>(), ","));
    return fmt::format("{} in [{:g}, {:g}]", schema["type"] == "integer" ? "INT" : "FLOAT",
                       schema["minimum"].get<double>(), schema["maximum"].get<double>());
}

CLI::Option* add_with_argument(CLI::App* command, CaseOverrides& overrides, const CaseSetting& setting) {
    const std::string place = setting.place();
    const auto yaml_of = [many = setting.flag_is_repeatable,
                          quotes = is_path(setting.schema)](const std::vector<std::string>& words) {
        if (quotes) return nlohmann::json(words.back()).dump();
        return many ? fmt::format("[{}]", fmt::join(words, ", ")) : words.back();
    };
    auto* option = command->add_option_function<std::vector<std::string>>(
        setting.flag,
        [&overrides, place, yaml_of](const std::vector<std::string>& words) { overrides.set(place, yaml_of(words)); },
        mesh::capitalised(setting.help));
    option->expected(1)->multi_option_policy(setting.flag_is_repeatable ? CLI::MultiOptionPolicy::TakeAll
                                                                        : CLI::MultiOptionPolicy::Throw);
    option->type_name(type_in_words(setting.schema));
    return option->check(
        CLI::Validator([place, yaml_of](std::string& word) { return objection_to_value(place, yaml_of({word})); }, ""));
}

}  // namespace

void add_flag(CLI::App* command, CaseOverrides& overrides, std::string_view place) {
    const CaseSetting& setting = setting_at(place);
    auto* option =
        setting.flag_value.empty()
            ? add_with_argument(command, overrides, setting)
            : command->add_flag_callback(
                  setting.flag, [&overrides, &setting] { overrides.set(setting.place(), setting.flag_value); },
                  mesh::capitalised(setting.flag_help.empty() ? setting.help : setting.flag_help));
    option->group(setting.group);
}

void add_flags_of(CLI::App* command, CaseOverrides& overrides, std::string_view group) {
    bool is_known = false;
    for (const CaseSetting& setting : settings()) {
        if (setting.group != group) continue;
        add_flag(command, overrides, setting.place());
        is_known = true;
    }
    if (!is_known) throw std::logic_error(fmt::format("there is no group of flags {}", group));
}

void add_body(CLI::App* command, std::string& body, const std::string& when) {
    command
        ->add_option("--body", body,
                     "Model that is diagnosed: reference (finite elements, " + when +
                         ")\nor skeleton, whose coarseness may be mistaken for physics")
        ->check(CLI::IsMember({"reference", "skeleton"}));
}

}  // namespace palpate::pipeline
