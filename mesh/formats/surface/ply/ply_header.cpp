#include "mesh/formats/surface/ply/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <sstream>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

std::optional<PlyType> type_named(const std::string& name) {
    constexpr std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                               {"uchar", "uint8"},
                                                               {"short", "int16"},
                                                               {"ushort", "uint16"},
                                                               {"int", "int32"},
                                                               {"uint", "uint32"},
                                                               {"float", "float32"},
                                                               {"double", "float64"}}};
    for (std::size_t i = 0; i < names.size(); ++i)
        if (name == names[i][0] || name == names[i][1]) return static_cast<PlyType>(i);
    return std::nullopt;
}

class HeaderReader {
public:
    HeaderReader(const std::string& content, const std::filesystem::path& file) : content_(content), file_(file) {}

    PlyHeader read() {
        if (next_line() != "ply") fail("a PLY begins with the line 'ply'. Is the extension right?");
        bool has_format = false;
        while (true) {
            std::istringstream line(next_line());
            std::string word;
            line >> word;
            if (word == "end_header") break;
            if (word == "format") {
                read_format(line);
                has_format = true;
            } else if (word == "element") {
                read_element(line);
            } else if (word == "property") {
                read_property(line);
            } else if (!word.empty() && word != "comment" && word != "obj_info") {
                fail(fmt::format("{} is no word of a PLY's head. Export the surface again.", cited(word)));
            }
        }
        if (!has_format) fail("the head has no line 'format'. Export the surface again.");
        header_.end = at_;
        return header_;
    }

private:
    std::string next_line() {
        const std::size_t end = content_.find('\n', at_);
        ++header_.lines;
        // No head is long: a binary file without line ends is none.
        if (end == std::string::npos || header_.lines > 1000)
            fail("the head has no 'end_header'. The file is cut off, or no PLY.");
        std::string line = content_.substr(at_, end - at_);
        at_ = end + 1;
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
        return line;
    }

    void read_format(std::istringstream& line) {
        std::string name;
        line >> name;
        if (name == "ascii")
            header_.encoding = PlyEncoding::Text;
        else if (name == "binary_little_endian")
            header_.encoding = PlyEncoding::Little;
        else if (name == "binary_big_endian")
            header_.encoding = PlyEncoding::Big;
        else
            fail(fmt::format("the format is {}; ascii, binary_little_endian and binary_big_endian are allowed.",
                             cited(name)));
    }

    void read_element(std::istringstream& line) {
        PlyElement element;
        std::string count;
        line >> element.name >> count;
        const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (error != std::errc() || end != count.data() + count.size())
            fail(fmt::format("the number of elements is {}; a whole number from 0 is allowed.", cited(count)));
        header_.elements.push_back(element);
    }

    void read_property(std::istringstream& line) {
        if (header_.elements.empty()) fail("'property' stands before any 'element'. Export the surface again.");
        std::string word, name;
        PlyProperty property;
        line >> word;
        if (word == "list") {
            line >> word;
            property.count = type(word);
            line >> word;
        }
        property.type = type(word);
        line >> property.name;
        header_.elements.back().properties.push_back(property);
    }

    PlyType type(const std::string& name) const {
        const auto found = type_named(name);
        if (!found)
            fail(fmt::format("{} is no type of a PLY (char, uchar, short, ushort, int, uint, float, double).",
                             cited(name)));
        return *found;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw InvalidInput(fmt::format("{}, line {}: {}", file_.string(), header_.lines, what));
    }

    const std::string& content_;
    const std::filesystem::path& file_;
    PlyHeader header_;
    std::size_t at_ = 0;
};

}  // namespace

std::size_t size_of(PlyType type) {
    return std::array<std::size_t, 8>{1, 1, 2, 2, 4, 4, 4, 8}[static_cast<std::size_t>(type)];
}

PlyHeader read_ply_header(const std::string& content, const std::filesystem::path& file) {
    return HeaderReader(content, file).read();
}

}  // namespace palpate::mesh
