#pragma once

#include "identify/live/filter.h"
#include "pipeline/command_line/terminal/outcome.h"

namespace palpate::pipeline::commands {

struct FollowOptions {
    std::filesystem::path model, set, output;
    bool standard_input = false;  // readings come as JSON lines there; else another program appends rows to the set
    double timeout = 0;           // without a reading for so long it ends [s]; 0: never, unless standard input closes
    identify::IdentifyOptions how;
    identify::FilterOptions filter;
    std::filesystem::path socket = {};  // readings come as JSON lines there, and are answered; empty: they do not
};

/// Takes in readings as they come, a line or JSON object on standard output for each, and leaves the cloud, from which
/// the next run goes on, in the output's folder after each; in the end the model and its posterior as well.
Outcome follow(const FollowOptions& options, const Common& common);

}  // namespace palpate::pipeline::commands
