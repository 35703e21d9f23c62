#pragma once

#include <functional>
#include <memory>
#include <string>

#include "pipeline/commands/common.h"

namespace CLI {
class App;
}

namespace palpate::pipeline {

/// Verbs and flags, as CLI11 parses them.
class CommandLine {
public:
    CommandLine();
    ~CommandLine();

    void set_up(CLI::App& app);
    std::string description() const;

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
