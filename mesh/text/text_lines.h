#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/types.h"

namespace palpate::mesh {

/// Walks through a text file line by line, cut into words; '#' begins a comment, blank lines are skipped.
class TextLines {
public:
    enum class Continuation { No, Backslash };
    TextLines(std::string_view content, std::filesystem::path file, Continuation continuation = Continuation::No);

    /// To the next line that holds words; false at the end.
    bool next();
    const std::vector<std::string_view>& words() const { return words_; }
    int line() const { return line_; }
    /// Bytes that are not read yet.
    std::size_t left() const { return content_.size() - at_; }
    /// "liver.obj, line 12"
    std::string where() const;

    /// Word i of the line as a finite number or a whole number. @throws InvalidInput, `what` says what it should be.
    double number(std::size_t i, std::string_view what) const;
    int integer(std::size_t i, std::string_view what) const;
    /// Words i, i+1, i+2 as a position.
    Vec3 position(std::size_t i) const;

private:
    std::string_view word(std::size_t i, std::string_view what) const;
    std::string_view take_line();

    std::string_view content_;
    std::filesystem::path file_;
    Continuation continuation_;
    std::size_t at_ = 0;
    int line_ = 0, lines_read_ = 0;
    std::vector<std::string_view> words_;
};

}  // namespace palpate::mesh
