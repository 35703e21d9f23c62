#include "pipeline/command_line/tree/usage_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <regex>

#include "pipeline/command_line/tree/command_tree.h"
#include "pipeline/command_line/tree/tree.h"

namespace palpate::pipeline {
namespace {

/// "a, b or c" of "a,b,c", which the list may have spaces in.
std::string one_of(const std::string& list, const char* last_word) {
    const std::string spaced = std::regex_replace(list, std::regex(",\\s*"), ", ");
    const std::size_t last = spaced.rfind(", ");
    return last == std::string::npos
               ? spaced
               : fmt::format("{} {} {}", spaced.substr(0, last), last_word, spaced.substr(last + 2));
}

/// What an option of the command needs, by the name that CLI11's messages have.
std::string needed_value(const CLI::App& command, const std::string& name) {
    const CLI::Option* own = command.get_option_no_throw(name);
    const CLI::Option* option = own ? own : command.get_parent()->get_option_no_throw(name);
    return option ? value_in_words(option_value(*option)) : "a value";
}

/// CLI11's sentence in ours.
std::string in_our_words(const CLI::App& command, const std::string& words) {
    static const std::regex beyond(R"((--?[\w-]+): Value (.*) not in range .*)");
    static const std::regex not_one_of(R"((\S+): (.*) not in \{(.*)\})");
    static const std::regex too_many(R"(The following arguments? (?:was|were) not expected: (?:.* )?(\S+))");
    static const std::regex group(R"(Exactly 1 option from \[(.*)\] is required(.*))");
    static const std::regex missing(R"((\S+): \d+ required .* missing)");
    static const std::regex twice(R"((\S+): At Most 1 required but received \d+)");
    static const std::regex excludes(R"((\S+) excludes (\S+))");
    static const std::regex required(R"((.*) is required)");
    std::smatch found;
    if (std::regex_match(words, found, beyond))
        return fmt::format("{}: '{}' is not {}", found[1].str(), found[2].str(), needed_value(command, found[1]));
    if (std::regex_match(words, found, not_one_of)) {
        const std::string name = found[1].str().starts_with("-") ? found[1].str() + ": " : "";
        return fmt::format("{}'{}' is not supported; use {}", name, found[2].str(), one_of(found[3], "or"));
    }
    if (std::regex_match(words, found, too_many)) return fmt::format("unexpected argument '{}'", found[1].str());
    if (std::regex_match(words, found, group))
        return found[2].length() > 0 ? fmt::format("give only one of {}", one_of(found[1], "and"))
                                     : fmt::format("one of {} is needed", one_of(found[1], "or"));
    if (std::regex_match(words, found, missing))
        return fmt::format("{} needs {}", found[1].str(), needed_value(command, found[1]));
    if (std::regex_match(words, found, twice)) return fmt::format("{} is given more than once", found[1].str());
    if (std::regex_match(words, found, excludes))
        return fmt::format("give only one of {} and {}", found[1].str(), found[2].str());
    if (std::regex_match(words, found, required)) return fmt::format("{} is needed", found[1].str());
    return words;
}

}  // namespace

std::string usage_error(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
    const CommandTree tree = tree_of(app);
    if (std::string slip = spelling_error(tree, arguments); !slip.empty()) return slip;
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    if (chosen.empty()) {
        std::vector<std::string> names;
        for (const CommandHelp& command : tree.subcommands) names.push_back(command.name);
        return fmt::format("a command is needed, one of {}; 'palpate --help' lists what they do",
                           fmt::join(names, ", "));
    }
    std::string words = error.what();
    while (!words.empty() && (words.back() == '\n' || words.back() == '.')) words.pop_back();
    const std::string name = chosen.front()->get_name();
    return fmt::format("palpate {}: {}; 'palpate {} --help' begins with examples", name,
                       in_our_words(*chosen.front(), words), name);
}

}  // namespace palpate::pipeline
