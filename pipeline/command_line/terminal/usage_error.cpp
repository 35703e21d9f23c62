#include "pipeline/command_line/terminal/usage_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <regex>

#include "pipeline/command_line/command_tree.h"
#include "pipeline/command_line/tree.h"

namespace palpate::pipeline {
namespace {

/// CLI11's sentence in ours.
std::string in_our_words(const std::string& words) {
    static const std::regex beyond(R"((--?[\w-]+): Value (.*) not in range (\S+) to (\S+))");
    static const std::regex not_one_of(R"((--?[\w-]+): (.*) not in \{(.*)\})");
    static const std::regex too_many(R"(The following arguments? (?:was|were) not expected: (.*))");
    static const std::regex one_of_group(R"(Exactly 1 option from \[(.*)\] is required.*)");
    std::smatch found;
    if (std::regex_match(words, found, beyond)) {
        constexpr double endless = 1e300;
        const double least = std::stod(found[3]), most = std::stod(found[4]);
        return most > endless ? fmt::format("{}: '{}' is no number of {:g} or more", found[1].str(), found[2].str(),
                                            least < 1e-300 ? 0 : least)
                              : fmt::format("{}: '{}' is no number from {:g} to {:g}", found[1].str(), found[2].str(),
                                            least, most);
    }
    if (std::regex_match(words, found, not_one_of))
        return fmt::format("{}: '{}' is none of {}", found[1].str(), found[2].str(), found[3].str());
    if (std::regex_match(words, found, too_many)) return fmt::format("'{}' is too many", found[1].str());
    if (std::regex_match(words, found, one_of_group)) {
        const std::string but_last = std::regex_replace(found[1].str(), std::regex(",(?=[^,]*$)"), " or ");
        return fmt::format("one of {} is needed", std::regex_replace(but_last, std::regex(","), ", "));
    }
    static const std::regex required(R"((.*) is required)");
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
        return fmt::format("a command is needed, one of {}; 'palpate --help' tells what they do",
                           fmt::join(names, ", "));
    }
    std::string words = error.what();
    while (!words.empty() && (words.back() == '\n' || words.back() == '.')) words.pop_back();
    const std::string name = chosen.front()->get_name();
    return fmt::format("palpate {}: {}; 'palpate {} --help' begins with examples", name, in_our_words(words), name);
}

}  // namespace palpate::pipeline
