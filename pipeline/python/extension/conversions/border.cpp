#include "pipeline/python/extension/conversions/border.h"

#include <utility>

#include "mesh/system/child_process.h"
#include "pipeline/command_line/terminal/system_limits.h"

namespace palpate::python {

Border::Border(const Call& call)
    : call_(call),
      question_([this] { ask(); }),
      listening_(listener_),
      interruption_(question_),
      threads_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(call.common.threads)) {
    pipeline::apply_system_limits(call.common.threads);
    listener_.message = [this](pipeline::Importance importance, const std::string& text) {
        if (mesh::is_child_process()) return;
        const py::gil_scoped_acquire held;
        call_.message(static_cast<int>(importance), text);
    };
    listener_.progress = [this](std::string_view what, double fraction) { tell_progress(what, fraction); };
}

void Border::ask() {
    constexpr std::chrono::milliseconds often{50};
    const auto now = std::chrono::steady_clock::now();
    // In a child process the lock may be held by a thread that is not there.
    if (now - asked_ < often || mesh::is_child_process()) return;
    asked_ = now;
    const py::gil_scoped_acquire held;
    raise_signals();
}

void Border::tell_progress(std::string_view what, double fraction) {
    if (mesh::is_child_process()) return;
    const py::gil_scoped_acquire held;
    raise_signals();
    if (!call_.progress.is_none()) call_.progress(py::str(what.data(), what.size()), fraction);
}

void translate_exceptions() {
    py::register_exception_translator([](std::exception_ptr thrown) {
        const auto raise = [](const char* name, const char* what) {
            const py::object kind = py::module_::import("palpate.errors").attr(name);
            PyErr_SetObject(kind.ptr(), kind(what).ptr());
        };
        try {
            if (thrown) std::rethrow_exception(std::move(thrown));
        } catch (const InvalidInput& e) {
            raise("InvalidInput", e.what());
        } catch (const LimitReached& e) {
            raise("LimitReached", e.what());
        } catch (const SolverFailure& e) {
            raise("SolverFailure", e.what());
        } catch (const IoError& e) {
            raise("FileError", e.what());
        } catch (const std::filesystem::filesystem_error& e) {
            raise("FileError", e.what());
        }
    });
}

}  // namespace palpate::python
