#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/command_line/tree/command_tree.h"

namespace palpate::pipeline {

/// What value an option takes, out of what CLI11 says of its type and its checks, such as "INT:INT in [1 - 1024]".
struct OptionValue {
    std::string word;                   // in a help: "N", "NUMBER", "PATH", "{full,burion2008}"
    std::vector<std::string> choices;   // none: any
    std::optional<double> least, most;  // of a number, where they say something
    bool excludes_least = false;
};
OptionValue option_value(const CLI::Option& option);

/// "a number from 1 to 1024", "full or burion2008": what to write.
std::string value_in_words(const OptionValue& value);

/// What CLI11 was given, as data.
CommandTree tree_of(const CLI::App& app);

}  // namespace palpate::pipeline
