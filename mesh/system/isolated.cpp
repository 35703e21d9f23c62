#include "mesh/system/isolated.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::mesh {
namespace {

// The first byte of what comes back.
constexpr char answered = 'a', invalid_input = 'i', solver_failure = 's', limit_reached = 'l', io_error = 'o';

std::string with_errors_told(const std::function<std::string()>& work) {
    try {
        return answered + work();
    } catch (const InvalidInput& error) {
        return invalid_input + std::string(error.what());
    } catch (const LimitReached& error) {
        return limit_reached + std::string(error.what());
    } catch (const SolverFailure& error) {
        return solver_failure + std::string(error.what());
    } catch (const IoError& error) {
        return io_error + std::string(error.what());
    }
}

[[noreturn]] void throw_ending(const ChildResult& child, const std::string& what, const std::string& advice,
                               const ChildLimits& limits) {
    using End = ChildResult::End;
    if (child.end == End::OutOfTime)
        throw LimitReached(fmt::format("{} did not end within {:.3g} s. {}", what, limits.seconds, advice));
    if (child.end == End::OutOfMemory)
        throw LimitReached(fmt::format("{} needs more than {:.0f} MiB. {}", what, limits.mebibytes, advice));
    throw SolverFailure(
        fmt::format("{} broke off{}. {}", what, child.signal ? fmt::format(" (signal {})", child.signal) : "", advice));
}

}  // namespace

ChildLimits limits_for(double triangles, double seconds) {
    constexpr double seconds_of_any = 5, mebibytes_of_any = 2048, mebibytes_each = 0.05, most_mebibytes = 12288;
    return {seconds_of_any + seconds * triangles,
            std::min(mebibytes_of_any + mebibytes_each * triangles, most_mebibytes)};
}

std::string isolated(const std::string& what, const std::string& advice, const ChildLimits& limits,
                     const std::function<std::string()>& work) {
    if (is_child_process()) return work();
    ChildResult child = run_in_child([&] { return with_errors_told(work); }, limits);
    if (child.end != ChildResult::End::Answered || child.answer.empty()) throw_ending(child, what, advice, limits);
    const char kind = child.answer.front();
    child.answer.erase(0, 1);
    if (kind == invalid_input) throw InvalidInput(child.answer);
    if (kind == limit_reached) throw LimitReached(child.answer);
    if (kind == solver_failure) throw SolverFailure(child.answer);
    if (kind == io_error) throw IoError(child.answer);
    return std::move(child.answer);
}

}  // namespace palpate::mesh
