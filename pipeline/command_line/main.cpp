#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <exception>
#include <memory>
#include <new>

#include "fem/distributed/processes.h"
#include "mesh/errors.h"
#include "pipeline/command_line/command_line.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/terminal/printed_units.h"
#include "pipeline/command_line/terminal/system_limits.h"

namespace {

using namespace palpate;
using namespace palpate::pipeline;

/// Runs a command within the limits of the system; what goes wrong becomes one message and an exit code.
commands::Outcome guarded(const std::function<commands::Outcome()>& command, int threads) {
    const auto failed = [](const std::string& message, commands::ExitCode code) {
        Console::error(message);
        return commands::Outcome{.text = {}, .json = {{"error", message}}, .code = code};
    };
    try {
        apply_system_limits(threads);
        return command();
    } catch (const InvalidInput& e) {
        return failed(e.what(), commands::bad_input);
    } catch (const IoError& e) {
        return failed(e.what(), commands::bad_input);
    } catch (const std::filesystem::filesystem_error& e) {
        return failed(e.what(), commands::bad_input);
    } catch (const SolverFailure& e) {
        return failed(e.what(), commands::numerical_failure);
    } catch (const std::bad_alloc&) {
        return failed("the memory is exhausted; choose larger elements (--edge-length) or fewer probes",
                      commands::numerical_failure);
    } catch (const std::exception& e) {
        return failed(fmt::format("internal error, please report it: {}", e.what()), commands::internal_error);
    }
}

/// What this process is one of, where mpirun started several. @return null where it may not be one of them.
std::unique_ptr<fem::Processes> processes() {
    try {
        return std::make_unique<fem::Processes>();
    } catch (const std::exception& e) {
        fmt::print(stderr, "palpate: {}\n", e.what());
        return nullptr;
    }
}

}  // namespace

int main(int argc, char** argv) {
    // Matrices of some MB come and go in inner loops: kept by the allocator, not handed back to the system each time.
    mallopt(M_MMAP_THRESHOLD, 256 << 20);
    mallopt(M_TRIM_THRESHOLD, 512 << 20);
    const std::unique_ptr<fem::Processes> all = processes();
    if (!all) return commands::bad_input;
    if (!all->lead()) {
        all->serve();
        return commands::done;
    }
    CommandLine line;
    if (const auto answered = line.parse(argc, argv)) return *answered;
    Console::set_up(line.verbosity());
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(line.common().threads));
    const commands::Outcome outcome = guarded(line.command(), line.common().threads);
    Console::end_progress();
    if (line.common().json) {
        // a command that serves has told its result when it began
        if (!outcome.json.is_null()) fmt::print("{}\n", outcome.json.dump(2));
    } else {
        fmt::print("{}", with_printed_units(outcome.text));
    }
    return outcome.code;
}
