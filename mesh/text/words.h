#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::mesh {

/// What is measured or meshed lies below, in any unit: squares and products of such numbers are finite.
inline constexpr double beyond_all_units = 1e30;

/// A number below that, as C and every spreadsheet write it, whatever the locale; nothing else, "nan" and "inf"
/// neither.
std::optional<double> parse_number(std::string_view text);

/// The same for a whole number.
std::optional<int> parse_integer(std::string_view text);

/// The length of the longest beginning that is UTF-8 [RFC 3629]; the text's own where all of it is.
std::size_t length_in_utf8(std::string_view text);

/// @throws InvalidInput naming the line and the byte where a text is no UTF-8. @param name the file's, for the message
void require_utf8(std::string_view text, const std::string& name);

/// Text of a file for use in a message: in quotes, without control characters and what is no UTF-8, cut where it is
/// long.
std::string cited(std::string_view text);

/// " (did you mean 'noise'?)" when one of the known words is spelled nearly like it, else "".
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

/// "1.8 % of the displacement"; from twice the whole on "41.2 times the displacement".
std::string share_of(double share, std::string_view whole);

/// "9.2 ± 0.5", as many digits as the standard deviation bears; without one (0, unknown), "9.21".
std::string with_sd(double value, double sd);

/// "1 probe", "3 probes". `many`: where it is not one with an "s".
std::string count_of(long count, const std::string& one, const std::string& many = {});

/// The order of names by the numbers in them: "scan_9" before "scan_10". Names whose numbers are equal, "a01" and
/// "a1", are ordered by their letters.
bool is_before_by_numbers(std::string_view a, std::string_view b);

/// With a capital at its beginning.
std::string capitalised(std::string text);

/// "a, b, c", each in quotes.
std::string listed(const std::vector<std::string>& words);

}  // namespace palpate::mesh
