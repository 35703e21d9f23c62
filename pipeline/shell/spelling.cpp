#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mesh/io/words.h"
#include "pipeline/shell/command_tree.h"

namespace palpate::pipeline {

std::string slip_in_spelling(const CommandTree& tree, const std::vector<std::string>& arguments) {
    const auto is_verb = [&](const std::string& word) {
        return std::ranges::find(tree.verbs, word, &VerbHelp::name) != tree.verbs.end();
    };
    const auto found = std::ranges::find_if(arguments, is_verb);
    if (found == arguments.end()) {
        const auto word = std::ranges::find_if(arguments, [](const std::string& a) { return !a.starts_with("-"); });
        if (word == arguments.end()) return {};
        std::vector<std::string> verbs;
        for (const VerbHelp& verb : tree.verbs) verbs.push_back(verb.name);
        return fmt::format("{} is no command{}; there are {}. 'palpate --help' tells what they do", mesh::cited(*word),
                           mesh::suggestion(*word, verbs), fmt::join(verbs, ", "));
    }

    const VerbHelp& verb = *std::ranges::find(tree.verbs, *found, &VerbHelp::name);
    std::vector<std::string> known{"--help"};
    for (const auto* flags : {&verb.flags, &tree.common}) {
        for (const FlagHelp& flag : *flags) known.insert(known.end(), flag.names.begin(), flag.names.end());
    }
    for (const std::string& argument : arguments) {
        const std::string name = argument.substr(0, argument.find('='));
        if (!name.starts_with("--") || std::ranges::find(known, name) != known.end()) continue;
        return fmt::format("palpate {} has no flag {}{}; 'palpate {} --help' lists them", verb.name, mesh::cited(name),
                           mesh::suggestion(name, known), verb.name);
    }
    return {};
}

}  // namespace palpate::pipeline
