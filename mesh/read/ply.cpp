#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>

#include "mesh/errors.h"
#include "mesh/io/words.h"
#include "mesh/read/polygons.h"

namespace palpate::mesh {
namespace {

enum class Type { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };
enum class Encoding { Text, Little, Big };

struct Property {
    std::string name;
    Type type;
    std::optional<Type> count;  // of a list: the type of its length
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::Text;
    std::vector<Element> elements;
    std::size_t end = 0;  // where the data begin
    int lines = 0;
};

std::size_t size_of(Type type) {
    return std::array<std::size_t, 8>{1, 1, 2, 2, 4, 4, 4, 8}[static_cast<std::size_t>(type)];
}

std::optional<Type> type_named(const std::string& name) {
    constexpr std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                               {"uchar", "uint8"},
                                                               {"short", "int16"},
                                                               {"ushort", "uint16"},
                                                               {"int", "int32"},
                                                               {"uint", "uint32"},
                                                               {"float", "float32"},
                                                               {"double", "float64"}}};
    for (std::size_t i = 0; i < names.size(); ++i)
        if (name == names[i][0] || name == names[i][1]) return static_cast<Type>(i);
    return std::nullopt;
}

class HeaderReader {
public:
    HeaderReader(const std::string& content, const std::filesystem::path& file) : content_(content), file_(file) {}

    Header read() {
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
            header_.encoding = Encoding::Text;
        else if (name == "binary_little_endian")
            header_.encoding = Encoding::Little;
        else if (name == "binary_big_endian")
            header_.encoding = Encoding::Big;
        else
            fail(fmt::format("the format is {}; ascii, binary_little_endian and binary_big_endian are allowed.",
                             cited(name)));
    }

    void read_element(std::istringstream& line) {
        Element element;
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
        Property property;
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

    Type type(const std::string& name) const {
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
    Header header_;
    std::size_t at_ = 0;
};

/// Takes one number after the other out of the data.
class Values {
public:
    Values(const std::string& content, const std::filesystem::path& file, const Header& header)
        : content_(content), file_(file), encoding_(header.encoding), at_(header.end), line_(header.lines + 1) {}

    double next(Type type) { return encoding_ == Encoding::Text ? next_word() : next_binary(type); }
    std::size_t left() const { return content_.size() - at_; }
    bool is_text() const { return encoding_ == Encoding::Text; }
    int line() const { return line_; }
    void in(const Element& element, std::size_t i) {
        element_ = &element;
        index_ = i;
        if (is_text()) skip_blanks();
    }

    std::string where() const {
        return is_text() ? fmt::format("{}, line {} ({} {})", file_.string(), line_, element_->name, index_)
                         : fmt::format("{}, {} {} (from 0)", file_.string(), element_->name, index_);
    }

private:
    void skip_blanks() {
        for (; at_ < content_.size() && std::string_view(" \t\r\n").find(content_[at_]) != std::string_view::npos;
             ++at_)
            line_ += content_[at_] == '\n';
    }

    double next_word() {
        skip_blanks();
        const std::size_t end = std::min(content_.find_first_of(" \t\r\n", at_), content_.size());
        const std::string_view word = std::string_view(content_).substr(at_, end - at_);
        if (word.empty()) fail_cut_off();
        at_ = end;
        const auto value = parse_number(word);
        if (!value)
            throw InvalidInput(
                fmt::format("{}: {} stands where a finite number is allowed. Mend the line, or export the surface "
                            "again.",
                            where(), cited(word)));
        return *value;
    }

    double next_binary(Type type) {
        std::array<char, 8> bytes{};
        const std::size_t size = size_of(type);
        if (left() < size) fail_cut_off();
        std::copy_n(content_.data() + at_, size, bytes.begin());
        at_ += size;
        if ((encoding_ == Encoding::Big) != (std::endian::native == std::endian::big))
            std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        const auto as = [&]<class T>(T value) {
            std::memcpy(&value, bytes.data(), sizeof value);
            return static_cast<double>(value);
        };
        switch (type) {
            case Type::Int8:
                return as(std::int8_t{});
            case Type::UInt8:
                return as(std::uint8_t{});
            case Type::Int16:
                return as(std::int16_t{});
            case Type::UInt16:
                return as(std::uint16_t{});
            case Type::Int32:
                return as(std::int32_t{});
            case Type::UInt32:
                return as(std::uint32_t{});
            case Type::Float:
                return as(float{});
            case Type::Double:
                return as(double{});
        }
        return 0;
    }

    [[noreturn]] void fail_cut_off() const {
        throw InvalidInput(
            fmt::format("{}: the file ends here; its head promises {} of them. It is cut off: export or copy it "
                        "again.",
                        where(), element_->count));
    }

    const std::string& content_;
    const std::filesystem::path& file_;
    Encoding encoding_;
    std::size_t at_;
    int line_;
    const Element* element_ = nullptr;
    std::size_t index_ = 0;
};

/// A promise of more elements than the bytes that follow can hold is not worth memory.
void check_count(const Element& element, const Values& values, const std::filesystem::path& file) {
    std::size_t least = 0;
    for (const Property& property : element.properties)
        least += values.is_text() ? 2 : size_of(property.count.value_or(property.type));
    if (least > 0 && element.count > 0 && element.count - 1 > values.left() / least)
        throw InvalidInput(
            fmt::format("{}: its head promises {} of '{}', but only {} bytes follow, enough for {}. The file is cut "
                        "off, or its head is wrong: export or copy it again.",
                        file.string(), element.count, element.name, values.left(), values.left() / least));
    if (least == 0 && element.count > 0)
        throw InvalidInput(fmt::format("{}: its element '{}' has no properties. Export the surface again.",
                                       file.string(), element.name));
}

void read_vertex(const Element& element, Values& values, Polygons& polygons) {
    Vec3 position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Property& property : element.properties) {
        auto repeat = property.count ? values.next(*property.count) : 1.0;
        for (; repeat >= 1; --repeat) {
            const double value = values.next(property.type);
            if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
                position[property.name[0] - 'x'] = value;
        }
    }
    polygons.points.push_back(position);
}

void read_face(const Element& element, Values& values, Polygons& polygons) {
    polygons.begin_polygon(values.is_text() ? values.line() : 0);
    for (const Property& property : element.properties) {
        const bool is_corners =
            property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
        auto repeat = property.count ? values.next(*property.count) : 1.0;
        for (; repeat >= 1; --repeat) {
            const double value = values.next(property.type);
            if (!is_corners) continue;
            if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max())
                throw InvalidInput(
                    fmt::format("{}: vertex {} does not exist. Mend the face, or export the surface again.",
                                values.where(), value));
            polygons.corners.push_back(static_cast<int>(value));
        }
    }
}

bool has(const Element& element, std::initializer_list<const char*> names) {
    return std::all_of(names.begin(), names.end(), [&](const char* name) {
        return std::any_of(element.properties.begin(), element.properties.end(),
                           [&](const Property& property) { return property.name == name; });
    });
}

}  // namespace

Polygons read_ply(const std::string& content, const std::filesystem::path& file) {
    const Header header = HeaderReader(content, file).read();
    Values values(content, file, header);
    Polygons polygons;
    for (const Element& element : header.elements) {
        check_count(element, values, file);
        if (element.name == "vertex" && !has(element, {"x", "y", "z"}))
            throw InvalidInput(fmt::format("{}: its vertices have no properties x, y and z. Export the surface again.",
                                           file.string()));
        if (element.name == "face" && !has(element, {"vertex_indices"}) && !has(element, {"vertex_index"}))
            throw InvalidInput(
                fmt::format("{}: its faces have no list 'vertex_indices'. Export the surface again.", file.string()));
        if (element.name == "tristrips")
            throw InvalidInput(fmt::format(
                "{}: holds triangle strips, which are not read. Export the surface with plain faces.", file.string()));
        for (std::size_t i = 0; i < element.count; ++i) {
            values.in(element, i);
            if (element.name == "vertex") {
                read_vertex(element, values, polygons);
            } else if (element.name == "face") {
                read_face(element, values, polygons);
            } else {
                for (const Property& property : element.properties) {
                    auto repeat = property.count ? values.next(*property.count) : 1.0;
                    for (; repeat >= 1; --repeat) values.next(property.type);
                }
            }
        }
    }
    return polygons;
}

}  // namespace palpate::mesh
