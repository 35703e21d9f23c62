#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::mesh {

/// What the head of a PLY file says of its data.
enum class PlyType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };
enum class PlyEncoding { Text, Little, Big };

struct PlyProperty {
    std::string name;
    PlyType type;
    std::optional<PlyType> count;  // of a list: the type of its length
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::Text;
    std::vector<PlyElement> elements;
    std::size_t end = 0;  // where the data begin
    int lines = 0;
};

/// Bytes of a number in a binary file.
std::size_t size_of(PlyType type);

/// @throws InvalidInput naming the line.
PlyHeader read_ply_header(const std::string& content, const std::filesystem::path& file);

}  // namespace palpate::mesh
