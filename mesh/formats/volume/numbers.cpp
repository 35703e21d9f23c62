#include "mesh/formats/volume/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

constexpr std::string_view white = " \t\r\n\v\f";

static_assert(std::endian::native == std::endian::little, "binary stretches are little-endian");

template <class T>
T value_of(std::string_view bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

std::int64_t whole_number(std::string_view word, std::string_view what, const std::string& where) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc{} && end == word.data() + word.size()) return value;
    throw InvalidInput(fmt::format("{}: {} is {}; a whole number is allowed. Mend the line, or export the mesh again.",
                                   where, what, cited(word)));
}

}  // namespace

int Numbers::next_int(std::string_view what) {
    if (binary_) return value_of<std::int32_t>(bytes(4));
    const std::int64_t value = next_long(what);
    if (value == static_cast<int>(value)) return static_cast<int>(value);
    throw InvalidInput(fmt::format("{}: {} is {}; less than 2^31 is allowed.", where(), what, value));
}

std::int64_t Numbers::next_long(std::string_view what) {
    if (binary_) return value_of<std::int64_t>(bytes(8));
    const std::string_view word = next_word();
    if (word.empty()) fail_cut_off(what);
    return whole_number(word, what, where());
}

double Numbers::next_double(std::string_view what) {
    if (binary_) {
        const auto value = value_of<double>(bytes(8));
        if (std::abs(value) < beyond_all_units) return value;
        throw InvalidInput(fmt::format("{}: {} is not finite. Export the mesh again.", where(), what));
    }
    const std::string_view word = next_word();
    if (word.empty()) fail_cut_off(what);
    if (const auto value = parse_number(word)) return *value;
    throw InvalidInput(fmt::format("{}: {} is {}; a finite number is allowed. Mend the line, or export the mesh again.",
                                   where(), what, cited(word)));
}

std::int64_t Numbers::next_count(std::string_view what, std::int64_t least_bytes) {
    const std::int64_t count = next_long(what);
    const auto left = static_cast<std::int64_t>(content_.size() - at_);
    if (count >= 0 && count <= left / least_bytes + 1) return count;
    throw InvalidInput(
        fmt::format("{}: {} is {}, but only {} bytes follow. The file is cut off, or its head is wrong: export it "
                    "again.",
                    where(), what, count, left));
}

std::string_view Numbers::next_word() {
    const std::string_view word = peek_word();
    at_ += word.size();
    return word;
}

std::string_view Numbers::peek_word() {
    skip_blanks();
    const std::size_t end = std::min(content_.find_first_of(white, at_), content_.size());
    return content_.substr(at_, end - at_);
}

void Numbers::skip_line() {
    const std::size_t end = content_.find('\n', at_);
    if (end != std::string_view::npos) ++line_;
    at_ = end == std::string_view::npos ? content_.size() : end + 1;
}

bool Numbers::skip_behind(std::string_view text) {
    const std::size_t found = content_.find(text, at_);
    const std::size_t end = found == std::string_view::npos ? content_.size() : found + text.size();
    line_ += static_cast<int>(std::count(content_.begin() + static_cast<std::ptrdiff_t>(at_),
                                         content_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    at_ = end;
    return found != std::string_view::npos;
}

std::string Numbers::where() const {
    return binary_ ? fmt::format("{}, byte {}", file_.string(), at_)
                   : fmt::format("{}, line {}", file_.string(), line_);
}

void Numbers::skip_blanks() {
    while (at_ < content_.size()) {
        const char c = content_[at_];
        if (c == '#') {
            skip_line();
            continue;
        }
        if (white.find(c) == std::string_view::npos) return;
        line_ += c == '\n';
        ++at_;
    }
}

std::string_view Numbers::bytes(std::size_t count) {
    if (content_.size() - at_ < count) fail_cut_off("the next number");
    at_ += count;
    return content_.substr(at_ - count, count);
}

void Numbers::fail_cut_off(std::string_view what) const {
    throw InvalidInput(
        fmt::format("{}: the file ends where {} should stand. It is cut off: export or copy it again.", where(), what));
}

}  // namespace palpate::mesh
