#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::mesh {

/// A line of an input file of Abaqus or CalculiX: "*NODE, NSET=ALL" or data behind such a line, cut at commas.
struct KeywordLine {
    std::string where;                              // "body.inp, line 12"
    std::string keyword;                            // in capitals, without the star; empty: data
    std::map<std::string, std::string> parameters;  // of a keyword; names and values in capitals
    std::vector<std::string> words;                 // of data, in capitals, without blanks at their ends

    std::string parameter(const std::string& name) const;  // empty: absent
    bool is_number(std::size_t i) const;
    /// @throws InvalidInput, `what` says what it should be.
    double number(std::size_t i, std::string_view what) const;
    std::int64_t integer(std::size_t i, std::string_view what) const;
};

/// All lines of the file and of those that it includes, in order, comments and blank lines left out; `files` are those
/// that were read. @throws IoError, InvalidInput for a file that includes itself or lies outside the file's folder.
std::vector<KeywordLine> read_keyword_lines(const std::filesystem::path& file,
                                            std::vector<std::filesystem::path>& files);

}  // namespace palpate::mesh
