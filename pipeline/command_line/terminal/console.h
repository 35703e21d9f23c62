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

    /// Progress of a step: a bar with the time that it takes on a terminal, elsewhere a plain line every ten seconds.
    /// Messages take its line; it comes back below them.
    static Progress progress();
    /// Takes a bar that is left away, for what is printed next.
    static void end_progress();
};

/// "identify [=====     ] 50 %, 12 s, about 12 s left" in one line of so many columns: where these are few the bar
/// shrinks and goes, then the time left, then the end of the name; the percentage stays.
std::string progress_line(const std::string& what, double done, double elapsed, const std::string& left,
                          std::size_t columns);

}  // namespace palpate::pipeline
