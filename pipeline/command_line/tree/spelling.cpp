#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "mesh/text/words.h"
#include "pipeline/command_line/tree/command_tree.h"

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

/// " (did you mean '--tolerance'?)" where a known word is spelled nearly like it, or is the only one that begins so.
std::string likely(const std::string& word, const std::vector<std::string>& known) {
    if (std::string near = mesh::suggestion(word, known); !near.empty()) return near;
    constexpr std::size_t least = 3;  // letters that say something: "--" stand before those of a flag
    const auto begins_so = [&](const std::string& one) { return one.starts_with(word); };
    if (word.size() < (word.starts_with("--") ? least + 2 : least) || std::ranges::count_if(known, begins_so) != 1)
        return {};
    return fmt::format(" (did you mean '{}'?)", *std::ranges::find_if(known, begins_so));
}

}  // namespace

std::string spelling_error(const CommandTree& tree, const std::vector<std::string>& arguments) {
    const std::string* word = first_word(tree, arguments);
    if (!word) return {};
    const auto found = std::ranges::find(tree.subcommands, *word, &CommandHelp::name);
    if (found == tree.subcommands.end()) {
        std::vector<std::string> subcommands;
        for (const CommandHelp& command : tree.subcommands) subcommands.push_back(command.name);
        return fmt::format("{} is not a command{}; there are {}. 'palpate --help' lists what they do",
                           mesh::cited(*word), likely(*word, subcommands), fmt::join(subcommands, ", "));
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
                           mesh::cited(name), likely(name, known), command.name);
    }
    return {};
}

}  // namespace palpate::pipeline
