#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/tree/command_tree.h"
#include "pipeline/command_line/tree/tree.h"
#include "pipeline/version.h"

namespace palpate::pipeline {
namespace {

/// A text as it may stand in roff: hyphens as typed, no line that begins with a command.
std::string roff(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '\\')
            safe += "\\e";
        else if (c == '-')
            safe += "\\-";
        else if ((c == '.' || c == '\'') && (safe.empty() || safe.back() == '\n'))
            safe += std::string("\\&") + c;
        else
            safe += c;
    }
    return safe;
}

std::string flags_in_roff(const std::vector<FlagHelp>& flags) {
    std::string text;
    for (const FlagHelp& flag : flags) {
        text += ".TP\n.B " + roff(fmt::format("{}", fmt::join(flag.names, ", ")));
        if (flag.takes_value) {
            // More than fit on a line are listed by a command of their own, as effects are.
            constexpr std::size_t most_choices = 10;
            const bool listed = !flag.choices.empty() && flag.choices.size() <= most_choices;
            text += " " + roff(listed               ? fmt::format("{}", fmt::join(flag.choices, "|"))
                               : flag.value.empty() ? "VALUE"
                                                    : flag.value);
        }
        text += "\n" + roff(flag.what) + "\n";
    }
    return text;
}

}  // namespace

std::string man_page(const CommandTree& tree, const std::string& version) {
    std::string text = fmt::format(
        ".TH PALPATE 1 \"\" \"palpate {}\" \"User Commands\"\n.SH NAME\npalpate \\- {}\n.SH SYNOPSIS\n.B palpate\n"
        "COMMAND [ARGUMENT...] [OPTION...]\n.SH DESCRIPTION\nUnits are mm, N, MPa and s, inside and in every output.\n"
        ".SH COMMANDS\n",
        version, roff(tree.what));
    for (const CommandHelp& command : tree.subcommands) {
        text += fmt::format(".SS palpate {} {}\n{}\n", roff(command.name),
                            roff(fmt::format("{}", fmt::join(command.positionals, " "))), roff(command.what));
        if (!command.examples.empty()) text += ".PP\n.nf\n.RS\n";
        for (const std::string& example : command.examples) text += roff(example) + "\n";
        if (!command.examples.empty()) text += ".RE\n.fi\n";
        text += flags_in_roff(command.flags);
    }
    return text + ".SH OPTIONS\nOf every command:\n" + flags_in_roff(tree.common) +
           ".SH EXIT STATUS\n.TP\n.B 0\ndone\n.TP\n.B 1\ninternal error\n.TP\n.B 2\nwrong usage\n.TP\n.B 3\nbad input\n"
           ".TP\n.B 4\nnumerical failure\n.TP\n.B 5\ntolerance or expectation not met\n.SH ENVIRONMENT\n.TP\n.B "
           "NO_COLOR\nNo colours where it is set.\n";
}

void Subcommands::add_man(CLI::App& app) {
    auto* sub = subcommand(app, "man", "The manual page, for 'man'.", "  palpate man | man -l -\n", {});
    sub->callback([this, &app] {
        const std::string text = man_page(tree_of(app), version);
        command = [text] { return commands::Outcome{.text = text, .json = {{"page", text}}}; };
    });
}

}  // namespace palpate::pipeline
