#include "mesh/text/text_lines.h"

#include <fmt/format.h>

#include <utility>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

void cut_words(std::string_view text, std::vector<std::string_view>& words) {
    std::size_t at = 0;
    while ((at = text.find_first_not_of(blanks, at)) != std::string_view::npos) {
        const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
        words.push_back(text.substr(at, end - at));
        at = end;
    }
}

}  // namespace

TextLines::TextLines(std::string_view content, std::filesystem::path file, Continuation continuation)
    : content_(content), file_(std::move(file)), continuation_(continuation) {
    if (content_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // byte-order mark
}

std::string_view TextLines::take_line() {
    const std::size_t end = std::min(content_.find('\n', at_), content_.size());
    std::string_view text = content_.substr(at_, end - at_);
    at_ = std::min(end + 1, content_.size());
    ++lines_read_;
    return text.substr(0, text.find('#'));
}

bool TextLines::next() {
    words_.clear();
    while (words_.empty() && at_ < content_.size()) {
        line_ = lines_read_ + 1;
        bool more = true;
        while (more && (at_ < content_.size() || line_ > lines_read_)) {
            std::string_view text = take_line();
            const std::size_t last = text.find_last_not_of(blanks);
            more = continuation_ == Continuation::Backslash && last != std::string_view::npos && text[last] == '\\';
            cut_words(more ? text.substr(0, last) : text, words_);
        }
    }
    return !words_.empty();
}

std::string TextLines::where() const { return fmt::format("{}, line {}", file_.string(), line_); }

std::string_view TextLines::word(std::size_t i, std::string_view what) const {
    if (i >= words_.size())
        throw InvalidInput(
            fmt::format("{}: {} is missing, the line has {} words. Mend the line, or export the surface again.",
                        where(), what, words_.size()));
    return words_[i];
}

double TextLines::number(std::size_t i, std::string_view what) const {
    const std::string_view text = word(i, what);
    if (const auto value = parse_number(text)) return *value;
    throw InvalidInput(
        fmt::format("{}: {} is {}; a finite number is allowed. Mend the line, or export the surface again.", where(),
                    what, cited(text)));
}

int TextLines::integer(std::size_t i, std::string_view what) const {
    const std::string_view text = word(i, what);
    if (const auto value = parse_integer(text)) return *value;
    throw InvalidInput(
        fmt::format("{}: {} is {}; a whole number is allowed. Mend the line, or export the surface again.", where(),
                    what, cited(text)));
}

Vec3 TextLines::position(std::size_t i) const {
    return {number(i, "the x coordinate"), number(i + 1, "the y coordinate"), number(i + 2, "the z coordinate")};
}

}  // namespace palpate::mesh
