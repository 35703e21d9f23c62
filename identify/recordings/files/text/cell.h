#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::identify {

/// How a table writes cells and numbers.
struct Dialect {
    char delimiter = ',';  // ' ': any number of blanks and tabs
    char decimal = '.';
    char thousands = '\0';  // between groups of three digits; '\0': none
};

/// Without blanks at its ends (no-break spaces too).
std::string_view trimmed(std::string_view text);

/// The cells of a line, without blanks at their ends and without the quotes around them.
std::vector<std::string_view> cells_of(std::string_view line, char delimiter);

struct CellValue {
    enum class Kind { number, missing, date, text };
    Kind kind = Kind::missing;
    double value = 0;  // of a number
};

/// What a cell holds. Missing are empty ones and what programs write instead: "nan", "NA", "--".
CellValue value_of(std::string_view cell, const Dialect& dialect);

/// A time of day ("12:01:33.5"), or a date with it ("2024-05-01T12:01:33", "01.05.2024 12:01:33"), as seconds since
/// midnight, or since 1970.
std::optional<double> clock_time(std::string_view cell);

/// "a comma", for notes.
std::string delimiter_in_words(char delimiter);

/// Letters in lower case (ASCII only, others as they are).
std::string lower_case(std::string_view text);

}  // namespace palpate::identify
