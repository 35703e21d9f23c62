#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "identify/recordings/files/file_map.h"
#include "identify/recordings/files/text/cell.h"

namespace palpate::identify {

/// A text whose way of writing was found out.
class TextFile {
public:
    /// @param text in UTF-8, lines ended by '\n'. @pre not moved while lines are in use
    TextFile(std::filesystem::path file, std::string text, std::string encoding, const FileMap& map);
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    const std::filesystem::path& file() const { return file_; }
    const Dialect& dialect() const { return dialect_; }
    std::size_t bytes() const { return text_.size(); }
    int lines() const { return static_cast<int>(lines_.size()); }
    std::string_view line(int i) const { return lines_.at(static_cast<std::size_t>(i)); }
    std::vector<std::string_view> cells(int i) const { return cells_of(line(i), dialect_.delimiter); }
    /// "run.csv, line 12" of line i, counted from 0 here and from 1 there.
    std::string where(int i) const;
    /// How it is written, in words.
    std::vector<std::string> notes() const;

private:
    std::filesystem::path file_;
    std::string text_, encoding_;
    std::vector<std::string_view> lines_;
    Dialect dialect_;
};

/// How the numbers of these lines are written: delimiter, decimal sign, thousands' separator. What the map tells is
/// taken.
Dialect sniff_dialect(const std::vector<std::string_view>& lines, const FileMap& map);

}  // namespace palpate::identify
