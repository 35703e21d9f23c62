#include "tests/fuzz/mutations.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>

namespace palpate::fuzz {
namespace {

constexpr std::array hostile_numbers{"0",         "-0",         "-1",         "1",          "nan",
                                     "-inf",      "1e308",      "-1e308",     "1e-320",     "0x10",
                                     "1e",        "2147483647", "2147483648", "4294967295", "99999999999999999999",
                                     "100000000", "",           "\"",         "''",         "1 2"};

std::size_t below(std::size_t end, std::mt19937_64& random) { return end == 0 ? 0 : random() % end; }

struct Piece {
    std::size_t begin, size;
};

Piece any_piece(const std::string& text, std::mt19937_64& random) {
    const std::size_t begin = below(text.size(), random);
    return {begin, below(std::min<std::size_t>(text.size() - begin, 64) + 1, random)};
}

/// The first number at or after a random place; empty where there is none.
Piece any_number(const std::string& text, std::mt19937_64& random) {
    const auto starts_number = [](unsigned char c) { return std::isdigit(c) != 0; };
    const auto goes_on = [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '+'; };
    const auto from = text.begin() + static_cast<std::ptrdiff_t>(below(text.size(), random));
    const auto begin = std::find_if(from, text.end(), starts_number),
               end = std::find_if_not(begin, text.end(), goes_on);
    return {static_cast<std::size_t>(begin - text.begin()), static_cast<std::size_t>(end - begin)};
}

void mutate_once(std::string& text, std::mt19937_64& random) {
    const Piece piece = any_piece(text, random);
    switch (random() % 8) {
        case 0:
            if (!text.empty()) text[piece.begin] = static_cast<char>(random());
            break;
        case 1:
            if (!text.empty()) text[piece.begin] ^= static_cast<char>(1U << (random() % 8));
            break;
        case 2:
            text.erase(piece.begin, piece.size);
            break;
        case 3:
            text.insert(piece.begin, text.substr(piece.begin, piece.size));
            break;
        case 4:
            text.insert(below(text.size() + 1, random), text.substr(piece.begin, piece.size));
            break;
        case 5:
            if (random() % 4 == 0) text.resize(piece.begin);
            break;
        default: {
            const Piece number = any_number(text, random);
            text.replace(number.begin, number.size, hostile_numbers[random() % hostile_numbers.size()]);
        }
    }
}

}  // namespace

int inputs(int usual) {
    const char* asked = std::getenv("PALPATE_FUZZ");
    return asked != nullptr ? std::atoi(asked) : usual;
}

std::string mutated(std::string text, std::mt19937_64& random) {
    for (auto times = 1 + random() % 4; times > 0; --times) mutate_once(text, random);
    return text;
}

}  // namespace palpate::fuzz
