// What the standard library of emscripten 3.1 (libc++ 14) still lacks, as far as the module uses it: algorithms on
// ranges, and numbers from text. Put before every source of the module by the compiler's -include.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <ranges>
#include <string>

#if _LIBCPP_VERSION < 15000

// NOLINTBEGIN: names are the standard's
namespace std::ranges {

template <class R, class T, class P = identity>
constexpr auto find(R&& r, const T& value, P p = {}) {
    return std::find_if(std::begin(r), std::end(r), [&](auto&& x) { return std::invoke(p, x) == value; });
}
template <class R, class F, class P = identity>
constexpr auto find_if(R&& r, F f, P p = {}) {
    return std::find_if(std::begin(r), std::end(r), [&](auto&& x) { return std::invoke(f, std::invoke(p, x)); });
}
template <class R, class F, class P = identity>
constexpr bool any_of(R&& r, F f, P p = {}) {
    return std::any_of(std::begin(r), std::end(r), [&](auto&& x) { return std::invoke(f, std::invoke(p, x)); });
}
template <class R, class T>
constexpr void fill(R&& r, const T& value) {
    std::fill(std::begin(r), std::end(r), value);
}
template <class R, class O>
constexpr void copy(R&& r, O out) {
    std::copy(std::begin(r), std::end(r), out);
}
template <class R, class O, class F>
constexpr void copy_if(R&& r, O out, F f) {
    std::copy_if(std::begin(r), std::end(r), out, [&](auto&& x) { return std::invoke(f, x); });
}
template <class I, class O, class F>
constexpr void transform(I begin, I end, O out, F f) {
    std::transform(begin, end, out, f);
}
template <class R, class C = less, class P = identity>
constexpr auto max_element(R&& r, C c = {}, P p = {}) {
    return std::max_element(std::begin(r), std::end(r),
                            [&](auto&& a, auto&& b) { return std::invoke(c, std::invoke(p, a), std::invoke(p, b)); });
}
template <class R>
constexpr auto max(R&& r) {
    return *std::max_element(std::begin(r), std::end(r));
}
template <class R, class C = less, class P = identity>
constexpr auto min_element(R&& r, C c = {}, P p = {}) {
    return std::min_element(std::begin(r), std::end(r),
                            [&](auto&& a, auto&& b) { return std::invoke(c, std::invoke(p, a), std::invoke(p, b)); });
}
template <class R, class I>
constexpr void nth_element(R&& r, I nth) {
    std::nth_element(std::begin(r), nth, std::end(r));
}
template <class R, class C = less, class P = identity>
constexpr void sort(R&& r, C c = {}, P p = {}) {
    std::sort(std::begin(r), std::end(r),
              [&](auto&& a, auto&& b) { return std::invoke(c, std::invoke(p, a), std::invoke(p, b)); });
}
template <class R, class C = less, class P = identity>
void stable_sort(R&& r, C c = {}, P p = {}) {
    std::stable_sort(std::begin(r), std::end(r),
                     [&](auto&& a, auto&& b) { return std::invoke(c, std::invoke(p, a), std::invoke(p, b)); });
}

}  // namespace std::ranges

namespace std {

inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    const string text(first, last);  // ends in a zero, as strtod needs
    char* end = nullptr;
    const double read = strtod(text.c_str(), &end);
    if (end == text.c_str()) return {first, errc::invalid_argument};
    value = read;
    return {first + (end - text.c_str()), errc()};
}

}  // namespace std
// NOLINTEND

#endif
