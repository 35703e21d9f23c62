#include "mesh/text/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>

#include "mesh/errors.h"

namespace palpate::mesh {

namespace {

template <class Number>
std::optional<Number> parse(std::string_view text) {
    const bool plus = text.starts_with('+');
    if (plus) text.remove_prefix(1);
    if (plus && text.starts_with('-')) return std::nullopt;
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// The least number of letters to insert, drop, replace, or swap with their neighbour.
std::size_t spelling_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> now(b.size() + 1);
    std::iota(last.begin(), last.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        now[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = std::min(now[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, now);
    }
    return last[b.size()];
}

/// Of the character in UTF-8 that the text begins with; 0: it begins with none.
std::size_t length_of_character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                               : first >= 0xE0 && first < 0xF0 ? 3
                               : first >= 0xF0 && first < 0xF5 ? 4
                                                               : 0;
    if (length == 0 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0U) != 0x80) return 0;
    // Neither longer than need be, nor half of a pair of UTF-16, nor beyond the last character.
    const unsigned second = byte(1);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) || (first == 0xF0 && second < 0x90) ||
        (first == 0xF4 && second >= 0x90))
        return 0;
    return length;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
    const auto value = parse<double>(text);
    return value && std::abs(*value) < beyond_all_units ? value : std::nullopt;
}

std::optional<int> parse_integer(std::string_view text) { return parse<int>(text); }

std::size_t length_in_utf8(std::string_view text) {
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t length = length_of_character(text.substr(at));
        if (length == 0) break;
        at += length;
    }
    return at;
}

void require_utf8(std::string_view text, const std::string& name) {
    const std::size_t valid = length_in_utf8(text);
    if (valid == text.size()) return;
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(valid), '\n');
    throw InvalidInput(fmt::format(
        "{}, line {}: the byte 0x{:02X} is no UTF-8. Save the file as UTF-8 (an editor's \"Save with encoding\", or "
        "iconv -f LATIN1 -t UTF-8).",
        name, line, static_cast<unsigned char>(text[valid])));
}

std::string cited(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string shown;
    for (std::size_t at = 0; at < std::min(text.size(), longest);) {
        const std::size_t length = length_of_character(text.substr(at));
        const auto first = static_cast<unsigned char>(text[at]);
        if (length == 0 || first < 0x20 || first == 0x7f)
            shown += '?';
        else
            shown += text.substr(at, length);
        at += std::max<std::size_t>(length, 1);
    }
    return fmt::format("'{}{}'", shown, text.size() > longest ? "..." : "");
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
    // A long word is no misspelling, and would take long to compare.
    if (known.empty() || word.size() > 64) return {};
    const auto nearest = std::ranges::min_element(known, {}, [&](const auto& w) { return spelling_distance(word, w); });
    if (spelling_distance(word, *nearest) > 1 + nearest->size() / 4) return {};
    return fmt::format(" (did you mean '{}'?)", *nearest);
}

std::string share_of(double share, std::string_view whole) {
    constexpr double as_times = 2;
    if (share < as_times) return fmt::format("{:.1f} % of {}", 100 * share, whole);
    return share < 1000 ? fmt::format("{:.3g} times {}", share, whole) : fmt::format("{:.0f} times {}", share, whole);
}

std::string with_sd(double value, double sd) {
    constexpr double exact = 1e-6;  // of the value: what is told to be known better was not measured
    if (!(sd > exact * std::abs(value))) return fmt::format("{:.3g}", value);
    // Two digits of it where the first is 1 or 2, else one.
    int place = static_cast<int>(std::floor(std::log10(sd)));
    const double leading = sd / std::pow(10.0, place);
    if (leading < 2.95) --place;
    constexpr int most_decimals = 9;
    if (-place > most_decimals) return fmt::format("{:.3g} ± {:.2g}", value, sd);
    const double unit = std::pow(10.0, place);
    const auto rounded = [&](double x) { return std::round(x / unit) * unit + 0.0; };  // no "-0"
    return fmt::format("{:.{}f} ± {:.{}f}", rounded(value), std::max(0, -place), rounded(sd), std::max(0, -place));
}

std::string count_of(long count, const std::string& one, const std::string& many) {
    return fmt::format("{} {}", count, count == 1 ? one : many.empty() ? one + "s" : many);
}

bool is_before_by_numbers(std::string_view a, std::string_view b) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto number = [&](std::string_view text, std::size_t& at) {
        while (at < text.size() && text[at] == '0') ++at;
        const std::size_t begin = at;
        while (at < text.size() && is_digit(text[at])) ++at;
        return text.substr(begin, at - begin);
    };
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (!is_digit(a[i]) || !is_digit(b[j])) {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i, ++j;
            continue;
        }
        const std::string_view first = number(a, i), second = number(b, j);
        if (first.size() != second.size()) return first.size() < second.size();
        if (first != second) return first < second;
    }
    const std::size_t left_of_a = a.size() - i, left_of_b = b.size() - j;
    return left_of_a != left_of_b ? left_of_a < left_of_b : a < b;
}

std::string capitalised(std::string text) {
    if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    return text;
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "'" : ", '") + word + "'";
    return text;
}

}  // namespace palpate::mesh
