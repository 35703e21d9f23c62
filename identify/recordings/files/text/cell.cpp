#include "identify/recordings/files/text/cell.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>

#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr std::string_view no_break_space = "\xC2\xA0";

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// The number without its thousands' separators and with a point; empty where they do not stand between threes.
std::string plain_number(std::string_view cell, const Dialect& dialect) {
    std::string plain;
    std::size_t since_separator = 0, digits = 0;
    bool grouped = false, in_whole = true;
    for (const char c : cell) {
        const bool is_separator = dialect.thousands != '\0' && c == dialect.thousands;
        if (in_whole && is_separator) {
            if (digits == 0 || (grouped ? since_separator != 3 : since_separator > 3)) return {};
            grouped = true;
            since_separator = 0;
            continue;
        }
        if (in_whole && !is_digit(c) && digits > 0) {
            if (grouped && since_separator != 3) return {};
            in_whole = false;
        }
        if (c == dialect.decimal) {
            plain += '.';
            continue;
        }
        if (c == '.' || c == ',') return {};
        if (in_whole && is_digit(c)) ++since_separator, ++digits;
        plain += c;
    }
    if (in_whole && grouped && since_separator != 3) return {};
    return plain;
}

bool is_missing_word(const std::string& word) {
    static constexpr std::array words{"nan", "na", "n/a", "n.a.", "null", "none", "-", "--", "---", "----", "#n/a",
                                      "#value!", "#div/0!", "1.#qnan", "-1.#ind", "1.#ind", "-nan", "+nan", "nil",
                                      "-nan(ind)", "missing", "(missing)",
                                      // as .NET writes it in Italian, German, Spanish, French
                                      "non un numero reale", "n. def.", "neun", "non num\xC3\xA9rique"};
    return std::ranges::find(words, word) != words.end();
}

bool holds_month(const std::string& word) {
    static constexpr std::array months{"jan", "feb", "mar", "apr", "may", "mai", "jun", "jul",
                                       "aug", "sep", "oct", "okt", "nov", "dec", "dez", "m\xC3\xA4r"};
    return std::ranges::any_of(months, [&](const char* month) { return word.find(month) != std::string::npos; });
}

/// What spreadsheets make of numbers: "12.05.2024", "2024-05-12", "12/5", "12-May", "May 12", "12:30".
bool looks_like_date(const std::string& word) {
    constexpr std::size_t longest = 30;  // characters: "Wednesday, 12 September 2024" has 28
    if (word.size() > longest || std::ranges::none_of(word, is_digit)) return false;
    std::size_t separators = 0;
    bool is_digits_only = true;
    for (std::size_t i = 0; i < word.size(); ++i) {
        const char c = word[i];
        const bool inside = i > 0 && is_digit(word[i - 1]);
        if ((c == '.' || c == '/' || c == ':' || c == '-') && inside)
            ++separators;
        else if (!is_digit(c) && c != ' ' && c != 't' && c != 'z' && !(c == ',' && separators >= 2))
            is_digits_only = false;
    }
    if (is_digits_only) return separators >= 2 || (separators == 1 && word.find_first_of("/:") != std::string::npos);
    return holds_month(word) && std::ranges::count_if(word, is_digit) <= 6;
}

/// Whole numbers and what separates them: "2024-05-01 12:01:33.5" is {2024, 5, 1, 12, 1} and 33.5.
struct ClockParts {
    std::vector<int> whole;
    double last = 0;
    std::string separators;
};

std::optional<ClockParts> clock_parts(std::string_view cell) {
    constexpr std::size_t most = 7;  // numbers before the last one, a bound: year to minute are five
    ClockParts parts;
    while (!cell.empty() && parts.whole.size() < most) {
        const std::size_t end = std::min(cell.find_first_not_of("0123456789"), cell.size());
        if (end == 0 || end > 9) return std::nullopt;
        const bool is_second = parts.separators.size() >= 2 && parts.separators.back() == ':' && end < cell.size() &&
                               (cell[end] == '.' || cell[end] == ',');
        if (is_second) {
            std::string second(cell);
            std::ranges::replace(second, ',', '.');
            if (second.ends_with('Z') || second.ends_with('z')) second.pop_back();
            const auto value = mesh::parse_number(second);
            if (!value || second.find_first_not_of("0123456789.") != std::string::npos) return std::nullopt;
            parts.last = *value;
            return parts;
        }
        const int value = mesh::parse_integer(cell.substr(0, end)).value_or(0);
        cell.remove_prefix(end);
        if (cell == "Z") cell = {};
        if (cell.empty()) {
            parts.last = value;
            return parts;
        }
        parts.whole.push_back(value);
        parts.separators += cell.front();
        cell.remove_prefix(1);
        while (cell.starts_with(' ')) cell.remove_prefix(1);
    }
    return std::nullopt;
}

/// Seconds from 1970 to a day; none where there is no such day.
std::optional<double> seconds_to_day(int year, int month, int day) {
    constexpr int first_year = 1900, last_year = 2200;  // wider than any recording's; a year beyond is a slip
    const std::chrono::year_month_day date(std::chrono::year(std::clamp(year, first_year, last_year)),
                                           std::chrono::month(static_cast<unsigned>(std::clamp(month, 0, 13))),
                                           std::chrono::day(static_cast<unsigned>(std::clamp(day, 0, 32))));
    if (year < first_year || year > last_year || !date.ok()) return std::nullopt;
    return 86400.0 * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

}  // namespace

std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\v\f";
    while (true) {
        const std::size_t first = text.find_first_not_of(blanks);
        if (first == std::string_view::npos) return {};
        text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
        if (text.starts_with(no_break_space))
            text.remove_prefix(no_break_space.size());
        else if (text.ends_with(no_break_space))
            text.remove_suffix(no_break_space.size());
        else
            return text;
    }
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
    std::vector<std::string_view> cells;
    const auto is_delimiter = [&](char c) { return delimiter == ' ' ? c == ' ' || c == '\t' : c == delimiter; };
    const auto add = [&](std::string_view cell) {
        cell = trimmed(cell);
        if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
            cell = trimmed(cell.substr(1, cell.size() - 2));
        cells.push_back(cell);
    };
    if (delimiter == ' ') line = trimmed(line);
    bool in_quotes = false;
    std::size_t start = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') in_quotes = !in_quotes;
        if (in_quotes || !is_delimiter(line[i])) continue;
        add(line.substr(start, i - start));
        if (delimiter == ' ')
            while (i + 1 < line.size() && is_delimiter(line[i + 1])) ++i;
        start = i + 1;
    }
    add(line.substr(std::min(start, line.size())));
    return cells;
}

CellValue value_of(std::string_view cell, const Dialect& dialect) {
    using Kind = CellValue::Kind;
    if (cell.empty()) return {Kind::missing, 0};
    const bool is_plain = dialect.decimal == '.' && dialect.thousands == '\0';
    if (is_plain) {
        if (const auto value = mesh::parse_number(cell)) return {Kind::number, *value};
    } else if (is_digit(cell.back())) {  // a comma at the end is no decimal one
        const std::string plain = plain_number(cell, dialect);
        if (const auto value = plain.empty() ? std::nullopt : mesh::parse_number(plain)) return {Kind::number, *value};
    }
    constexpr std::size_t longest_word = 40;  // characters, longer than any word for what is missing
    if (cell.size() > longest_word) return {Kind::text, 0};
    const std::string word = lower_case(cell);
    if (is_missing_word(word)) return {Kind::missing, 0};
    return {looks_like_date(word) ? Kind::date : Kind::text, 0};
}

std::optional<double> clock_time(std::string_view cell) {
    const auto parts = clock_parts(cell);
    if (!parts) return std::nullopt;
    const auto& whole = parts->whole;
    const std::string& separators = parts->separators;
    const auto of_day = [](double hour, double minute, double second) -> std::optional<double> {
        if (hour > 23 || minute > 59 || second >= 61) return std::nullopt;  // 60: a leap second
        return 3600 * hour + 60 * minute + second;
    };
    if (separators == "::") return of_day(whole[0], whole[1], parts->last);
    if (separators.size() != 5 || separators.substr(3) != "::") return std::nullopt;
    const bool is_year_first = separators.starts_with("--") || separators.starts_with("//");
    const bool is_day_first = separators.starts_with("..");
    const auto day = is_year_first && whole[0] > 31 ? seconds_to_day(whole[0], whole[1], whole[2])
                     : is_day_first                 ? seconds_to_day(whole[2], whole[1], whole[0])
                     : is_year_first                ? seconds_to_day(whole[2], whole[0], whole[1])
                                                    : std::nullopt;
    const auto seconds = of_day(whole[3], whole[4], parts->last);
    if (!day || !seconds) return std::nullopt;
    return *day + *seconds;
}

std::string delimiter_in_words(char delimiter) {
    switch (delimiter) {
        case ',':
            return "a comma";
        case ';':
            return "a semicolon";
        case '\t':
            return "a tab";
        default:
            return "blanks";
    }
}

}  // namespace palpate::identify
