#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/formats/yaml/yaml_fields.h"
#include "pipeline/case/case.h"

namespace palpate::pipeline {

/// A setting of a case, declared once. The reader and the writer of case.yaml, the flag, the JSON schema, the commented
/// case of `palpate new` and the keys of finished stages all come from this declaration.
struct CaseSetting {
    std::string section;            // of case.yaml; empty: its top level
    std::string key;                // there
    std::string help;               // one line: what it is, with its unit, and what 0 stands for
    nlohmann::ordered_json schema;  // type, bounds or choices: a JSON schema without description and default
    std::function<void(const mesh::YamlFields&, Case&)> read;  // where the key is there; @throws InvalidInput
    std::function<nlohmann::json(const Case&)> value;          // null: not said

    std::string flag;             // "--spheres"; empty: the command line has none
    std::string group;            // of the flag in `--help`
    std::string flag_help = {};   // of a flag that says the contrary; empty: `help`
    std::string flag_value = {};  // the value that a flag without argument stands for; empty: it takes an argument
    bool flag_is_repeatable = false;
    std::string stage;  // of a run whose result depends on it; empty: none

    std::string place() const { return section.empty() ? key : section + "." + key; }
};

/// All of them, in the order of case.yaml.
const std::vector<CaseSetting>& settings();

/// By its place in case.yaml: "skeleton.spheres", "seed".
const CaseSetting& setting_at(std::string_view place);

/// What a stage of a run depends on among the settings, by place: the key that tells whether it has to run again.
nlohmann::json settings_of_stage(const Case& settings, std::string_view stage);

/// A line of case.yaml with its explanation; empty where it is not said.
std::string setting_yaml(const Case& settings, const CaseSetting& setting);

/// A section of case.yaml with every setting and its explanation; empty where none of them is said.
std::string section_yaml(const Case& settings, const std::string& section);

/// A line of case.yaml, and a section's lines, for a user to edit: the values given by place stand there, the others'
/// defaults behind a '#'.
struct Example {
    std::string_view place, value;
};
std::string example_yaml(const CaseSetting& setting, const std::vector<Example>& examples);
std::string example_section_yaml(const std::string& section, const std::vector<Example>& examples);

/// The JSON schema of one of them, with description and default.
nlohmann::ordered_json schema_of(const CaseSetting& setting);

}  // namespace palpate::pipeline
