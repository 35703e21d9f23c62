#pragma once

#include <string>
#include <vector>

namespace palpate::pipeline {

// What the command line understands, as data: completions and the man page are made from it.

struct FlagHelp {
    std::vector<std::string> names;  // "-o", "--output"
    std::string what;                // in a sentence
    bool takes_value = false;
    std::vector<std::string> choices;  // the values that there are; none: any
    bool repeatable = false;           // it may be given more than once
    std::string value = {};            // what its value is called: "N", "NUMBER", "PATH"; empty: it takes none
};

struct CommandHelp {
    std::string name, what;
    std::vector<std::string> examples;          // lines to type
    std::vector<std::string> positionals;       // "MODEL", "SET"
    std::vector<std::string> positional_words;  // values that the first positional may take; none: files
    std::vector<FlagHelp> flags;
};

struct CommandTree {
    std::string what;
    std::vector<CommandHelp> subcommands;
    std::vector<FlagHelp> common;  // of every command
};

/// A script that completes subcommands, flags, their choices and names of effects.
std::string bash_completion(const CommandTree& tree);
std::string zsh_completion(const CommandTree& tree);

/// Spelling errors in a command, with the nearest known word, or the only one that begins so: "'rnu' is not a command
/// (did you mean 'run'?); ...". "" where all subcommands and flags are known.
std::string spelling_error(const CommandTree& tree, const std::vector<std::string>& arguments);

/// The page that `man palpate` shows, in roff.
std::string man_page(const CommandTree& tree, const std::string& version);

}  // namespace palpate::pipeline
