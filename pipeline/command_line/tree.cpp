#include "pipeline/command_line/tree.h"

#include <sstream>

#include "identify/effects/catalogue.h"

namespace palpate::pipeline {
namespace {

std::vector<std::string> effect_names() {
    std::vector<std::string> names;
    for (const auto& effect : identify::all_effects()) names.push_back(effect->name());
    return names;
}

/// The values in "TEXT:{a,b,c}", as CLI11 tells a choice.
std::vector<std::string> choices_in(const std::string& type) {
    const std::size_t open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    std::istringstream words(type.substr(open + 1, close - open - 1));
    std::vector<std::string> choices;
    for (std::string word; std::getline(words, word, ',');) choices.push_back(word);
    return choices;
}

FlagHelp flag_of(const CLI::Option& option) {
    FlagHelp flag{.names = {},
                  .what = option.get_description(),
                  .takes_value = option.get_expected_max() > 0,
                  .choices = {},
                  .repeatable = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll};
    for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
    flag.choices = choices_in(option.get_type_name());
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
