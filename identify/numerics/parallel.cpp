#include "identify/numerics/parallel.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "mesh/system/interruption.h"

namespace palpate::identify {

void for_each_in_parallel(int count, int threads, const std::function<void(int)>& task) {
    std::atomic<int> next = 0;
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const int workers = std::max(1, std::min(threads, count));
    const auto available =
        static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    const int inner = std::clamp(threads / workers, 1, available);
    const auto share = [&](int i) { tbb::task_arena(inner).execute([&] { task(i); }); };
    const auto work = [&] {
        for (int i = next++; i < count; i = next++) {
            try {
                Interruption::ask();
                share(i);
            } catch (...) {
                const std::scoped_lock lock(failure_mutex);
                if (!failure) failure = std::current_exception();
                next = count;
            }
        }
    };

    // the caller works too
    std::vector<std::jthread> helpers;
    for (int i = 1; i < workers; ++i) helpers.emplace_back(work);
    work();
    helpers.clear();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate::identify
