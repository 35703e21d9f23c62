#pragma once

#include <functional>

namespace palpate::identify {

/// Calls task(0) .. task(count - 1) on so many threads, in any order; where tasks are fewer they share the rest in what
/// they do in parallel themselves. The first exception is thrown on.
void for_each_in_parallel(int count, int threads, const std::function<void(int)>& task);

}  // namespace palpate::identify
