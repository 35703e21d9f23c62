#include "pipeline/command_line/tree/tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <regex>
#include <sstream>

#include "identify/effects/catalogue.h"

namespace palpate::pipeline {
namespace {

std::vector<std::string> effect_names() {
    std::vector<std::string> names;
    for (const auto& effect : identify::all_effects()) names.push_back(effect->name());
    return names;
}

/// The values in "TEXT:{a,b,c}", as CLI11 states a choice.
std::vector<std::string> choices_in(const std::string& type) {
    const std::size_t open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    std::istringstream words(type.substr(open + 1, close - open - 1));
    std::vector<std::string> choices;
    for (std::string word; std::getline(words, word, ',');) choices.push_back(word);
    return choices;
}

/// Bounds as checks state them, "in [1 - 1024]", ours "in [0, 0.5]", "POSITIVE" and "NONNEGATIVE".
void read_bounds(const std::string& type, OptionValue& value) {
    static const std::regex range(R"(in \[(\S+)(?:,| -) (\S+)\])");
    constexpr double any = 1e9, tiny = 1e-9;  // bounds that stand for none: so far numbers are numbers at all
    std::smatch found;
    if (type.find("NONNEGATIVE") != std::string::npos) {
        value.least = 0;
    } else if (type.find("POSITIVE") != std::string::npos) {
        value.least = 0;
        value.excludes_least = true;
    } else if (std::regex_search(type, found, range)) {
        const double least = std::stod(found[1]), most = std::stod(found[2]);
        value.excludes_least = least == tiny;
        if (least > -any) value.least = value.excludes_least ? 0 : least;
        if (most < any) value.most = most;
    }
}

FlagHelp flag_of(const CLI::Option& option) {
    FlagHelp flag{.names = {},
                  .what = option.get_description(),
                  .takes_value = option.get_expected_max() > 0,
                  .choices = {},
                  .repeatable = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll};
    for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
    const OptionValue value = option_value(option);
    flag.choices = value.choices;
    if (flag.takes_value) flag.value = value.word;
    const bool of_effects = option.check_lname("hide") || option.check_lname("add") || option.check_lname("without");
    if (of_effects) flag.choices = effect_names();
    return flag;
}

/// Flags of a command; positionals go into `positionals` where that is asked for.
std::vector<FlagHelp> flags_of(const CLI::App& app, std::vector<std::string>* positionals) {
    std::vector<FlagHelp> flags;
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_positional()) {
            if (positionals) positionals->push_back(option->get_name(true));
        } else if (!option->check_lname("help")) {
            flags.push_back(flag_of(*option));
        }
    }
    // Groups of options that exclude each other are subcommands without a name.
    for (const CLI::App* group : app.get_subcommands([](const CLI::App* one) { return one->get_name().empty(); })) {
        const std::vector<FlagHelp> more = flags_of(*group, positionals);
        flags.insert(flags.end(), more.begin(), more.end());
    }
    return flags;
}

CommandHelp command_help(const CLI::App& app) {
    CommandHelp command{
        .name = app.get_name(), .what = {}, .examples = {}, .positionals = {}, .positional_words = {}, .flags = {}};
    std::istringstream lines(app.get_description());
    std::getline(lines, command.what);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("  ")) command.examples.push_back(line.substr(2));
    }
    command.flags = flags_of(app, &command.positionals);
    if (command.name == "effects") command.positional_words = effect_names();
    if (command.name == "completion") command.positional_words = {"bash", "zsh"};
    return command;
}

}  // namespace

OptionValue option_value(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    OptionValue value{.word = {}, .choices = choices_in(type), .least = {}, .most = {}};
    if (!value.choices.empty()) {
        value.word = fmt::format("{{{}}}", fmt::join(value.choices, ","));
    } else if (type.starts_with("INT") || type.starts_with("UINT")) {
        value.word = "N";
        read_bounds(type, value);
    } else if (type.starts_with("FLOAT")) {
        value.word = "NUMBER";
        read_bounds(type, value);
    } else if (const std::size_t form = type.find(":"); form != std::string::npos) {
        value.word = type.substr(form + 1);  // EFFECT[:name=value,...]
    } else {
        value.word = type == "PATH" || option.check_lname("output") ? "PATH" : "VALUE";
    }
    return value;
}

std::string value_in_words(const OptionValue& value) {
    if (!value.choices.empty()) {
        const std::vector<std::string> but_last(value.choices.begin(), value.choices.end() - 1);
        return but_last.empty() ? value.choices.back()
                                : fmt::format("{} or {}", fmt::join(but_last, ", "), value.choices.back());
    }
    if (value.word == "VALUE") return "a value";
    if (value.word == "PATH") return "a path";
    if (value.word != "N" && value.word != "NUMBER") return value.word;
    if (value.least && value.most) return fmt::format("a number from {:g} to {:g}", *value.least, *value.most);
    if (value.least && value.excludes_least) return "a number above 0";
    if (value.least) return fmt::format("a number of {:g} or more", *value.least);
    return "a number";
}

CommandTree tree_of(const CLI::App& app) {
    CommandTree tree;
    const std::string description = app.get_description();
    tree.what = description.substr(0, description.find('\n'));
    tree.common = flags_of(app, nullptr);
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        tree.subcommands.push_back(command_help(*command));
    }
    return tree;
}

}  // namespace palpate::pipeline
