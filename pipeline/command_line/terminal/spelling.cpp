#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "mesh/text/words.h"
#include "pipeline/command_line/command_tree.h"

namespace palpate::pipeline {

namespace {

/// The first argument that is neither a flag nor the value of one: it should be a command. Null: there is none.
const std::string* first_word(const CommandTree& tree, const std::vector<std::string>& arguments) {
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        if (!arguments[i].starts_with("-")) return &arguments[i];
        const bool has_value = std::ranges::any_of(tree.common, [&](const FlagHelp& flag) {
            return flag.takes_value && std::ranges::find(flag.names, arguments[i]) != flag.names.end();
        });
        if (has_value) ++i;
    }
    return nullptr;
}

}  // namespace

std::string spelling_error(const CommandTree& tree, const std::vector<std::string>& arguments) {
    const std::string* word = first_word(tree, arguments);
    if (!word) return {};
    const auto found = std::ranges::find(tree.subcommands, *word, &CommandHelp::name);
    if (found == tree.subcommands.end()) {
        std::vector<std::string> subcommands;
        for (const CommandHelp& command : tree.subcommands) subcommands.push_back(command.name);
        return fmt::format("{} is no command{}; there are {}. 'palpate --help' tells what they do", mesh::cited(*word),
                           mesh::suggestion(*word, subcommands), fmt::join(subcommands, ", "));
    }

    const CommandHelp& command = *found;
    std::vector<std::string> known{"--help", "-h"};
    for (const auto* flags : {&command.flags, &tree.common}) {
        for (const FlagHelp& flag : *flags) known.insert(known.end(), flag.names.begin(), flag.names.end());
    }
    for (const std::string& argument : arguments) {
        const std::string name = argument.substr(0, argument.find('='));
        const bool is_letter = name.size() == 2 && name[0] == '-' && std::isalpha(static_cast<unsigned char>(name[1]));
        if (!(name.starts_with("--") || is_letter) || std::ranges::find(known, name) != known.end()) continue;
        return fmt::format("palpate {} has no flag {}{}; 'palpate {} --help' lists them", command.name,
                           mesh::cited(name), mesh::suggestion(name, known), command.name);
    }
    return {};
}

}  // namespace palpate::pipeline
