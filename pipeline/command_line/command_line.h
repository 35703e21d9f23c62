#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "pipeline/command_line/commands.h"

namespace palpate::pipeline {

/// Subcommands and flags, as CLI11 parses them.
class CommandLine {
public:
    CommandLine();
    ~CommandLine();

    /// Help, version and wrong usage are answered here: the exit code then, else nothing.
    std::optional<commands::ExitCode> parse(int argc, char** argv);

    // After parsing:
    const commands::Common& common() const;
    Verbosity verbosity() const;
    /// The command that was asked for, with its options.
    std::function<commands::Outcome()> command() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::pipeline
