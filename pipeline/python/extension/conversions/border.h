#pragma once

#include <pybind11/pybind11.h>
#include <tbb/global_control.h>

#include <chrono>

#include "mesh/errors.h"
#include "mesh/system/interruption.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/terminal/listener.h"

// Between Python and the libraries: who holds the interpreter's lock, who hears of progress, and what ends a call.

namespace palpate::python {

namespace py = pybind11;

/// How a call works, and who is told.
struct Call {
    pipeline::commands::Common common;
    py::object progress;  // callable(what, fraction), or None
    py::object message;   // callable(importance, text)
};

/// Hears progress and messages for Python, and asks it whether to go on (Ctrl-C). What a callback raises ends the work:
/// it passes through the libraries as py::error_already_set.
class Border {
public:
    explicit Border(const Call& call);

private:
    void ask();
    void tell_progress(std::string_view what, double fraction);

    const Call& call_;
    std::chrono::steady_clock::time_point asked_ = std::chrono::steady_clock::now();
    pipeline::Listener listener_;
    std::function<void()> question_;
    pipeline::Listening listening_;
    Interruption interruption_;
    tbb::global_control threads_;
};

/// Raises what a signal (Ctrl-C) asks for, if there is one. @pre the lock is held.
inline void raise_signals() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// What `work` returns, done without the interpreter's lock.
template <typename Work>
auto at_work(const Call& call, Work&& work) {
    raise_signals();
    Border border(call);
    try {
        const py::gil_scoped_release released;
        return work();
    } catch (const SolverFailure&) {  // a child process that Ctrl-C ended, too
        raise_signals();
        throw;
    }
}

/// Exceptions of the libraries as those of the package.
void translate_exceptions();

}  // namespace palpate::python
