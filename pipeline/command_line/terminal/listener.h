#pragma once

#include <functional>
#include <string>

#include "mesh/progress.h"

namespace palpate::pipeline {

enum class Importance { detail, notice, warning, error };

/// Who is told what a person would read on standard error, where commands are called by another program.
struct Listener {
    std::function<void(Importance, const std::string& text)> message;
    Progress progress;  // may be empty
};

/// For as long as this lives the console of this thread tells a listener, and prints nothing. @pre it outlives this.
class Listening {
public:
    explicit Listening(const Listener& to);
    ~Listening();
    Listening(const Listening&) = delete;
    Listening& operator=(const Listening&) = delete;

private:
    const Listener* before_;
};

}  // namespace palpate::pipeline
