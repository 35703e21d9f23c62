#pragma once

#include <functional>
#include <string_view>

namespace palpate {

/// Told now and then what is being done and how much of it, [0, 1]. May be empty. Called from one thread at a time.
using Progress = std::function<void(std::string_view what, double fraction)>;

inline void report(const Progress& progress, std::string_view what, double fraction) {
    if (progress) progress(what, fraction);
}

}  // namespace palpate
