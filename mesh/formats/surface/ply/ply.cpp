#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "mesh/errors.h"
#include "mesh/formats/surface/ply/ply_header.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// Takes one number after the other out of the data.
class Values {
public:
    Values(const std::string& content, const std::filesystem::path& file, const PlyHeader& header)
        : content_(content), file_(file), encoding_(header.encoding), at_(header.end), line_(header.lines + 1) {}

    double next(PlyType type) { return encoding_ == PlyEncoding::Text ? next_word() : next_binary(type); }
    /// How many numbers the property holds here: one, or as many as its list says (none, where that is nonsense).
    std::size_t next_count(const PlyProperty& property) {
        if (!property.count) return 1;
        const double count = next(*property.count);
        return count >= 1 ? static_cast<std::size_t>(std::min(count, 1e15)) : 0;
    }
    std::size_t left() const { return content_.size() - at_; }
    bool is_text() const { return encoding_ == PlyEncoding::Text; }
    int line() const { return line_; }
    void in(const PlyElement& element, std::size_t i) {
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

    double next_binary(PlyType type) {
        std::array<char, 8> bytes{};
        const std::size_t size = size_of(type);
        if (left() < size) fail_cut_off();
        std::copy_n(content_.data() + at_, size, bytes.begin());
        at_ += size;
        if ((encoding_ == PlyEncoding::Big) != (std::endian::native == std::endian::big))
            std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        const auto as = [&]<class T>(T value) {
            std::memcpy(&value, bytes.data(), sizeof value);
            return static_cast<double>(value);
        };
        switch (type) {
            case PlyType::Int8:
                return as(std::int8_t{});
            case PlyType::UInt8:
                return as(std::uint8_t{});
            case PlyType::Int16:
                return as(std::int16_t{});
            case PlyType::UInt16:
                return as(std::uint16_t{});
            case PlyType::Int32:
                return as(std::int32_t{});
            case PlyType::UInt32:
                return as(std::uint32_t{});
            case PlyType::Float:
                return as(float{});
            case PlyType::Double:
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
    PlyEncoding encoding_;
    std::size_t at_;
    int line_;
    const PlyElement* element_ = nullptr;
    std::size_t index_ = 0;
};

/// A promise of more elements than the bytes that follow can hold is not worth memory.
void check_count(const PlyElement& element, const Values& values, const std::filesystem::path& file) {
    std::size_t least = 0;
    for (const PlyProperty& property : element.properties)
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

void read_vertex(const PlyElement& element, Values& values, Polygons& polygons) {
    Vec3 position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const PlyProperty& property : element.properties) {
        for (std::size_t k = values.next_count(property); k > 0; --k) {
            const double value = values.next(property.type);
            if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
                position[property.name[0] - 'x'] = value;
        }
    }
    polygons.points.push_back(position);
}

int vertex_of(double value, const Values& values) {
    if (value == std::floor(value) && std::abs(value) <= std::numeric_limits<int>::max())
        return static_cast<int>(value);
    throw InvalidInput(fmt::format("{}: vertex {} does not exist. Mend the face, or export the surface again.",
                                   values.where(), value));
}

bool is_list_of_vertices(const PlyProperty& property) {
    return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Rows of triangles of which every other one is turned; -1 ends a row. Corners that are repeated, to go from one row
/// to the next, make no triangle.
void read_strips(const PlyElement& element, Values& values, Polygons& polygons) {
    for (const PlyProperty& property : element.properties) {
        std::vector<int> row;
        for (std::size_t k = values.next_count(property); k > 0; --k) {
            const double value = values.next(property.type);
            if (!is_list_of_vertices(property)) continue;
            if (value == -1) {
                row.clear();
                continue;
            }
            row.push_back(vertex_of(value, values));
            if (row.size() < 3) continue;
            const bool is_turned = row.size() % 2 == 0;
            const auto last = row.end();
            const std::array corners{is_turned ? last[-2] : last[-3], is_turned ? last[-3] : last[-2], last[-1]};
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2]) continue;
            polygons.begin_polygon(values.is_text() ? values.line() : 0);
            polygons.corners.insert(polygons.corners.end(), corners.begin(), corners.end());
        }
    }
}

void read_face(const PlyElement& element, Values& values, Polygons& polygons) {
    polygons.begin_polygon(values.is_text() ? values.line() : 0);
    for (const PlyProperty& property : element.properties) {
        const bool is_corners = is_list_of_vertices(property);
        for (std::size_t k = values.next_count(property); k > 0; --k) {
            const double value = values.next(property.type);
            if (is_corners) polygons.corners.push_back(vertex_of(value, values));
        }
    }
}

bool has(const PlyElement& element, std::initializer_list<const char*> names) {
    return std::all_of(names.begin(), names.end(), [&](const char* name) {
        return std::any_of(element.properties.begin(), element.properties.end(),
                           [&](const PlyProperty& property) { return property.name == name; });
    });
}

}  // namespace

Polygons read_ply(const std::string& content, const std::filesystem::path& file) {
    const PlyHeader header = read_ply_header(content, file);
    Values values(content, file, header);
    Polygons polygons;
    for (const PlyElement& element : header.elements) {
        check_count(element, values, file);
        if (element.name == "vertex" && !has(element, {"x", "y", "z"}))
            throw InvalidInput(fmt::format("{}: its vertices have no properties x, y and z. Export the surface again.",
                                           file.string()));
        const bool is_strips = element.name == "tristrips";
        if ((element.name == "face" || is_strips) && std::ranges::none_of(element.properties, is_list_of_vertices))
            throw InvalidInput(fmt::format("{}: its {} have no list 'vertex_indices'. Export the surface again.",
                                           file.string(), is_strips ? "triangle strips" : "faces"));
        for (std::size_t i = 0; i < element.count; ++i) {
            values.in(element, i);
            if (element.name == "vertex") {
                read_vertex(element, values, polygons);
            } else if (element.name == "face") {
                read_face(element, values, polygons);
            } else if (is_strips) {
                read_strips(element, values, polygons);
            } else {
                for (const PlyProperty& property : element.properties) {
                    for (std::size_t k = values.next_count(property); k > 0; --k) values.next(property.type);
                }
            }
        }
    }
    return polygons;
}

}  // namespace palpate::mesh
