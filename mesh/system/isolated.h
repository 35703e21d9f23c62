#pragma once

#include <functional>
#include <string>

#include "mesh/system/bytes.h"
#include "mesh/system/child_process.h"

namespace palpate::mesh {

/// Limits for work on so many triangles, each of them worth `seconds` at most: on top of what any body takes.
ChildLimits limits_for(double triangles, double seconds);

/// What `work` returns, from a child process: what a broken surface does to a library there does no harm here. In a
/// child process already, it runs at once.
/// @param what does it, for messages: "The repair"; advice: what to do when it does not come to an end
/// @throws what `work` throws of InvalidInput, SolverFailure and IoError; SolverFailure when it crashed; LimitReached.
std::string isolated(const std::string& what, const std::string& advice, const ChildLimits& limits,
                     const std::function<std::string()>& work);

/// The same for what to_bytes() and from_bytes() know.
template <class Result>
Result isolated_as(const std::string& what, const std::string& advice, const ChildLimits& limits,
                   const std::function<Result()>& work) {
    if (is_child_process()) return work();
    Result result;
    from_bytes(isolated(what, advice, limits, [&] { return to_bytes(work()); }), result);
    return result;
}

}  // namespace palpate::mesh
