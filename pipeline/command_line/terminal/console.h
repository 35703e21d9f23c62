#pragma once

#include <string>
#include <vector>

#include "mesh/progress.h"

namespace palpate::pipeline {

enum class Verbosity { quiet, normal, verbose };

/// What a person reads while a command works: messages and progress, all on standard error. Standard output is for
/// results. Colours and a progress bar on a terminal only, and not where NO_COLOR is set.
class Console {
public:
    static void set_up(Verbosity verbosity);

    /// An assumption or a decision that the user did not ask for and should know.
    static void notice(const std::string& text);
    static void notices(const std::vector<std::string>& texts);
    static void warning(const std::string& text);
    static void error(const std::string& text);
    static void detail(const std::string& text);  // with -v only

    /// Progress of a step: a bar with the time that it takes on a terminal, plain lines now and then elsewhere.
    /// Messages take its line; it comes back below them.
    static Progress progress();
    /// Takes a bar that is left away, for what is printed next.
    static void end_progress();
};

}  // namespace palpate::pipeline
