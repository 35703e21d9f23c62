#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/tree/command_tree.h"
#include "pipeline/command_line/tree/tree.h"

namespace palpate::pipeline {
namespace {

std::string all_names(const std::vector<FlagHelp>& flags) {
    std::string names;
    for (const FlagHelp& flag : flags) {
        for (const std::string& name : flag.names) names += (names.empty() ? "" : " ") + name;
    }
    return names;
}

/// Cases of a shell's `case`: after such a flag, these values.
std::string choices_by_flag(const std::vector<FlagHelp>& flags, const char* indent) {
    std::string cases;
    for (const FlagHelp& flag : flags) {
        if (flag.choices.empty()) continue;
        cases +=
            fmt::format("{}{}) choices=\"{}\" ;;\n", indent, fmt::join(flag.names, "|"), fmt::join(flag.choices, " "));
    }
    return cases;
}

/// A text within single quotes of zsh, where brackets and colons have a meaning.
std::string zsh_quoted(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '\'')
            safe += "'\\''";
        else if (c == '[' || c == ']' || c == ':')
            safe += std::string("\\") + c;
        else
            safe += c == '\n' ? ' ' : c;
    }
    return safe;
}

/// '(-o --output)'{-o,--output=}'[what]:value:action': said once, the value of a long name in its word or the next one.
std::string zsh_flag(const FlagHelp& flag) {
    const std::string value =
        !flag.takes_value
            ? ""
            : ":value:" + (flag.choices.empty() ? "_files" : fmt::format("({})", fmt::join(flag.choices, " ")));
    std::vector<std::string> names = flag.names;
    for (std::string& name : names) {
        if (flag.takes_value && name.starts_with("--")) name += "=";
    }
    const std::string how_often = flag.repeatable ? "'*'" : fmt::format("'({})'", fmt::join(flag.names, " "));
    return how_often + (names.size() == 1 ? names.front() : fmt::format("{{{}}}", fmt::join(names, ","))) +
           fmt::format("'[{}]{}'", zsh_quoted(flag.what), value);
}

}  // namespace

std::string bash_completion(const CommandTree& tree) {
    std::string subcommands, cases;
    for (const CommandHelp& command : tree.subcommands) {
        subcommands += (subcommands.empty() ? "" : " ") + command.name;
        cases += fmt::format("    {})\n      flags=\"{}\"\n", command.name, all_names(command.flags));
        if (!command.positional_words.empty())
            cases += fmt::format("      words=\"{}\"\n", fmt::join(command.positional_words, " "));
        const std::string choices = choices_by_flag(command.flags, "        ");
        if (!choices.empty()) cases += "      case \"$before\" in\n" + choices + "      esac\n";
        cases += "      ;;\n";
    }
    return fmt::format(
        R"(# Completion of palpate for bash: source this file, or put it into /usr/share/bash-completion/completions/palpate.
_palpate() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" command="" flags="" words="" choices="" word
  COMPREPLY=()
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    [[ "$word" != -* ]] && {{ command="$word"; break; }}
  done
  case "$command" in
    "") COMPREPLY=($(compgen -W "{subcommands} {common}" -- "$current")); return ;;
{cases}  esac
  if [[ -n "$choices" ]]; then COMPREPLY=($(compgen -W "$choices" -- "$current"))
  elif [[ "$current" == -* ]]; then COMPREPLY=($(compgen -W "$flags {common}" -- "$current"))
  elif [[ -n "$words" ]]; then COMPREPLY=($(compgen -W "$words" -- "$current"))
  else COMPREPLY=($(compgen -f -- "$current")); compopt -o filenames 2>/dev/null
  fi
}}
complete -F _palpate palpate
)",
        fmt::arg("subcommands", subcommands), fmt::arg("common", all_names(tree.common)), fmt::arg("cases", cases));
}

std::string zsh_completion(const CommandTree& tree) {
    std::string common, subcommands, cases;
    for (const FlagHelp& flag : tree.common) common += "    " + zsh_flag(flag) + "\n";
    for (const CommandHelp& command : tree.subcommands) {
        subcommands += fmt::format("    '{}:{}'\n", command.name, zsh_quoted(command.what));
        cases += fmt::format("    {})\n      _arguments $common", command.name);
        for (const FlagHelp& flag : command.flags) cases += " \\\n        " + zsh_flag(flag);
        cases += command.positional_words.empty()
                     ? " \\\n        '*:file:_files' ;;\n"
                     : fmt::format(" \\\n        '*:name:({})' ;;\n", fmt::join(command.positional_words, " "));
    }
    return fmt::format(
        R"(#compdef palpate
# Completion of palpate for zsh: put this file as _palpate into a folder of $fpath.
_palpate() {{
  local context state state_descr line
  typeset -A opt_args
  local -a common=(
{}  )
  local -a subcommands=(
{}  )
  _arguments -C $common '(-)1:command:->command' '(-)*::argument:->of_verb'
  case "$state" in
    command) _describe command subcommands; return ;;
    of_verb) ;;
    *) return ;;
  esac
  case "$words[1]" in
{}  esac
}}
_palpate "$@"
)",
        common, subcommands, cases);
}

void Subcommands::add_completion(CLI::App& app) {
    auto* sub = subcommand(app, "completion", "A script that completes commands in a shell.",
                           "  source <(palpate completion bash)\n  palpate completion zsh > ~/.zfunc/_palpate\n", {});
    auto* shell = sub->add_option("SHELL", "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
    sub->callback([this, &app, shell] {
        const CommandTree tree = tree_of(app);
        const std::string text = shell->as<std::string>() == "zsh" ? zsh_completion(tree) : bash_completion(tree);
        command = [text] { return commands::Outcome{.text = text, .json = {{"script", text}}}; };
    });
}

}  // namespace palpate::pipeline
