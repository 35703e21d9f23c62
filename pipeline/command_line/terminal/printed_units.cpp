#include "pipeline/command_line/terminal/printed_units.h"

#include <cctype>

namespace palpate::pipeline {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::string with_printed_units(const std::string& text) {
    constexpr const char *square = "²", *cube = "³", *times = "·";
    std::string printed;
    const auto at = [&](std::size_t i) { return i < text.size() ? text[i] : '\0'; };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool after_letter = i > 0 && is_letter(text[i - 1]);
        const bool is_power = after_letter && text[i] == '^' && (at(i + 1) == '2' || at(i + 1) == '3') &&
                              std::isdigit(static_cast<unsigned char>(at(i + 2))) == 0;
        if (is_power) {
            printed += at(++i) == '2' ? square : cube;
        } else if (text[i] == '*' && i > 0 && text[i - 1] == 'N' && at(i + 1) == 'm') {
            printed += times;
        } else {
            printed += text[i];
        }
    }
    return printed;
}

}  // namespace palpate::pipeline
