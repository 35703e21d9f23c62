#pragma once

#include <chrono>
#include <thread>

namespace palpate {

/// Asks every few milliseconds until it holds. False: it does not after a minute, far longer than what tests wait for.
template <class Condition>
bool comes_true(const Condition& condition) {
    const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > last) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

}  // namespace palpate
