#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mesh/text/words.h"
#include "pipeline/command_line/command_tree.h"

namespace palpate::pipeline {

std::string spelling_error(const CommandTree& tree, const std::vector<std::string>& arguments) {
    const auto is_verb = [&](const std::string& word) {
        return std::ranges::find(tree.subcommands, word, &CommandHelp::name) != tree.subcommands.end();
    };
    const auto found = std::ranges::find_if(arguments, is_verb);
    if (found == arguments.end()) {
        const auto word = std::ranges::find_if(arguments, [](const std::string& a) { return !a.starts_with("-"); });
        if (word == arguments.end()) return {};
        std::vector<std::string> subcommands;
        for (const CommandHelp& command : tree.subcommands) subcommands.push_back(command.name);
        return fmt::format("{} is no command{}; there are {}. 'palpate --help' tells what they do", mesh::cited(*word),
                           mesh::suggestion(*word, subcommands), fmt::join(subcommands, ", "));
    }

    const CommandHelp& command = *std::ranges::find(tree.subcommands, *found, &CommandHelp::name);
    std::vector<std::string> known{"--help"};
    for (const auto* flags : {&command.flags, &tree.common}) {
        for (const FlagHelp& flag : *flags) known.insert(known.end(), flag.names.begin(), flag.names.end());
    }
    for (const std::string& argument : arguments) {
        const std::string name = argument.substr(0, argument.find('='));
        if (!name.starts_with("--") || std::ranges::find(known, name) != known.end()) continue;
        return fmt::format("palpate {} has no flag {}{}; 'palpate {} --help' lists them", command.name,
                           mesh::cited(name), mesh::suggestion(name, known), command.name);
    }
    return {};
}

}  // namespace palpate::pipeline
