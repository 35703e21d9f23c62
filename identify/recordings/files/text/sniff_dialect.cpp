#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "identify/recordings/files/text/decoding/text_file.h"

namespace palpate::identify {
namespace {

using Lines = std::vector<std::string_view>;

/// Enough of them to tell a habit, from all parts of the file.
Lines sample_of(const Lines& lines) {
    constexpr std::size_t most = 4000;  // lines, which are read within milliseconds
    const std::size_t step = 1 + lines.size() / most;
    Lines sample;
    for (std::size_t i = 0; i < lines.size(); i += step) sample.push_back(lines[i]);
    return sample;
}

/// What the cells of a file tell of commas and points in numbers.
struct SignEvidence {
    int comma_decimal = 0, point_decimal = 0;      // "0,5", "12,3456", "1.234,5": can be nothing else
    int comma_grouped = 0, point_grouped = 0;      // "1,234,567", "1,234.5"
    int comma_undecided = 0, point_undecided = 0;  // "1,234"
    int blank_grouped = 0, quote_grouped = 0;      // "1 234,5", "1'234.5"
};

bool is_grouped(std::string_view cell, char separator) {
    const Dialect grouped{.decimal = separator == '.' ? ',' : '.', .thousands = separator};
    return value_of(cell, grouped).kind == CellValue::Kind::number;
}

void weigh(std::string_view cell, SignEvidence& evidence) {
    constexpr std::size_t longest_number = 40;  // characters: 17 digits, sign, exponent and blanks are fewer
    const bool is_numeric = cell.size() <= longest_number && cell.find_first_not_of("0123456789+-.,eE' ") == cell.npos;
    if (!is_numeric) return;
    const auto commas = std::ranges::count(cell, ','), points = std::ranges::count(cell, '.');
    if (cell.find(' ') != cell.npos &&
        (is_grouped(cell, ' ') || value_of(cell, {.decimal = ',', .thousands = ' '}).kind == CellValue::Kind::number))
        ++evidence.blank_grouped;
    if (cell.find('\'') != cell.npos && is_grouped(cell, '\'')) ++evidence.quote_grouped;
    if (commas > 0 && points > 0) {
        const bool comma_is_last = cell.rfind(',') > cell.rfind('.');
        if (comma_is_last && commas == 1 && is_grouped(cell, '.')) ++evidence.comma_decimal, ++evidence.point_grouped;
        if (!comma_is_last && points == 1 && is_grouped(cell, ',')) ++evidence.point_decimal, ++evidence.comma_grouped;
        return;
    }
    const char sign = commas > 0 ? ',' : '.';
    if (commas + points == 0) return;
    if (commas + points > 1) {
        if (is_grouped(cell, sign)) ++(commas > 0 ? evidence.comma_grouped : evidence.point_grouped);
        return;
    }
    const std::size_t at = cell.find(sign), sign_end = cell.find_first_of("0123456789");
    if (sign_end == cell.npos) return;
    const std::size_t before = at > sign_end ? at - sign_end : 0;
    const std::size_t after = std::min(cell.find_first_not_of("0123456789", at + 1), cell.size()) - at - 1;
    const bool could_be_group =
        after == 3 && before >= 1 && before <= 3 && cell[sign_end] != '0' && cell.find_first_of("eE") == cell.npos;
    if (commas > 0) ++(could_be_group ? evidence.comma_undecided : evidence.comma_decimal);
    if (points > 0) ++(could_be_group ? evidence.point_undecided : evidence.point_decimal);
}

Dialect decided(char delimiter, const SignEvidence& evidence, const FileMap& map) {
    Dialect dialect{.delimiter = delimiter};
    // Undecided ones are decimal, unless the other sign is.
    const bool comma = evidence.comma_decimal != evidence.point_decimal
                           ? evidence.comma_decimal > evidence.point_decimal
                           : evidence.comma_undecided > 0 && evidence.point_decimal + evidence.point_undecided == 0 &&
                                 evidence.comma_grouped == 0;
    // Between commas a number with one stands in quotes, where only groups of thousands are usual, too.
    const bool is_between_commas = delimiter == ',' && evidence.comma_decimal == 0;
    dialect.decimal = map.decimal.value_or(comma && !is_between_commas ? ',' : '.');
    const bool is_comma = dialect.decimal == ',';
    const int grouped = is_comma ? evidence.point_grouped + evidence.point_undecided
                                 : evidence.comma_grouped + evidence.comma_undecided;
    if (delimiter == ' ') return dialect;
    if (grouped > 0)
        dialect.thousands = is_comma ? '.' : ',';
    else if (evidence.blank_grouped > 0)
        dialect.thousands = ' ';
    else if (evidence.quote_grouped > 0)
        dialect.thousands = '\'';
    return dialect;
}

struct Judged {
    Dialect dialect;
    int score = 0;  // numbers in rows of the commonest width, less what is neither number nor missing there
};

Judged judged(const Lines& lines, char delimiter, const FileMap& map) {
    SignEvidence evidence;
    for (const std::string_view line : lines)
        for (const std::string_view cell : cells_of(line, delimiter)) weigh(cell, evidence);
    const Dialect dialect = decided(delimiter, evidence, map);

    // Cutting "1,5;2,5;3,5" at commas gives two numbers and two texts; a name beside a number is none worse than none.
    constexpr int worth_of_number = 3, price_of_text = 2;
    std::map<std::size_t, int> score_of_width;
    for (const std::string_view line : lines) {
        const auto cells = cells_of(line, delimiter);
        int score = 0;
        for (const std::string_view cell : cells) {
            const auto kind = value_of(cell, dialect).kind;
            if (kind == CellValue::Kind::number) score += worth_of_number;
            if (kind == CellValue::Kind::text) score -= price_of_text;
        }
        if (score > 0) score_of_width[cells.size()] += score;
    }
    int most = 0;
    for (const auto& [width, score] : score_of_width) most = std::max(most, score);
    return {dialect, most};
}

/// One column of numbers with decimal commas, which cutting at commas makes two of: "0,038" has a part that no whole
/// number begins with, or all second parts are equally long and there are three letters and more in them.
bool is_one_column_of_commas(const Lines& lines) {
    int rows = 0, leading_zeros = 0;
    for (const std::string_view line : lines) {
        const std::string_view text = trimmed(line);
        if (text.find_first_not_of("0123456789+-,") != text.npos || text.empty()) continue;
        if (std::ranges::count(text, ',') != 1) return false;
        const std::string_view after = text.substr(text.find(',') + 1);
        if (after.empty() || std::isdigit(static_cast<unsigned char>(after.front())) == 0) return false;
        ++rows;
        if (after.size() > 1 && after.front() == '0') ++leading_zeros;
    }
    return rows > 0 && leading_zeros > 0;
}

}  // namespace

Dialect sniff_dialect(const std::vector<std::string_view>& lines, const FileMap& map) {
    const Lines sample = sample_of(lines);
    if (map.delimiter) return judged(sample, *map.delimiter, map).dialect;
    // In this order where they are equally good, as without rows of numbers, and occur: blanks also separate what tabs
    // do.
    const auto occurs = [&](char delimiter) {
        return std::ranges::any_of(sample, [&](std::string_view line) { return line.find(delimiter) != line.npos; });
    };
    Judged best = judged(sample, '\t', map);
    for (const char delimiter : {';', ',', ' '}) {
        const Judged other = judged(sample, delimiter, map);
        const bool is_as_good = other.score == best.score && occurs(delimiter) && !occurs(best.dialect.delimiter);
        if (other.score > best.score || is_as_good) best = other;
    }
    if (best.dialect.delimiter == ',' && !map.decimal && is_one_column_of_commas(sample))
        best.dialect = {.delimiter = ';', .decimal = ','};
    return best.dialect;
}

}  // namespace palpate::identify
