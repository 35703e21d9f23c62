#include "pipeline/command_line/terminal/system_limits.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <csignal>

#include "fem/linear_algebra/memory/blas_buffers.h"
#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

constexpr rlim_t megabyte = 1'000'000;

/// Libraries and a small body, and for each thread a stack, an arena and a BLAS buffer of 134 MB.
rlim_t least_address_space(int threads) { return (400 + 220 * static_cast<rlim_t>(threads)) * megabyte; }

}  // namespace

void apply_system_limits(int threads) {
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) != 0 || space.rlim_cur == RLIM_INFINITY) return;
    const rlim_t least = least_address_space(threads);
    if (space.rlim_cur < least) {
        throw InvalidInput(fmt::format(
            "the address space is limited to {} MB (ulimit -v), and palpate needs {} MB with {} threads; raise the "
            "limit{}",
            space.rlim_cur / megabyte, least / megabyte, threads, threads > 1 ? " or choose fewer --threads" : ""));
    }
    fem::take_blas_buffers(threads);
}

}  // namespace palpate::pipeline
