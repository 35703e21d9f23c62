#include <fmt/format.h>

#include <map>

#include "mesh/errors.h"
#include "mesh/formats/label_image/text_head.h"
#include "mesh/formats/label_image/voxels.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

using Kind = VoxelType::Kind;

/// [MetaIO documentation, ElementType]
const std::map<std::string, VoxelType> meta_types{
    {"MET_CHAR", {Kind::Signed, 1}},         {"MET_UCHAR", {Kind::Unsigned, 1}}, {"MET_SHORT", {Kind::Signed, 2}},
    {"MET_USHORT", {Kind::Unsigned, 2}},     {"MET_INT", {Kind::Signed, 4}},     {"MET_UINT", {Kind::Unsigned, 4}},
    {"MET_LONG", {Kind::Signed, 4}},         {"MET_ULONG", {Kind::Unsigned, 4}}, {"MET_LONG_LONG", {Kind::Signed, 8}},
    {"MET_ULONG_LONG", {Kind::Unsigned, 8}}, {"MET_FLOAT", {Kind::Float, 4}},    {"MET_DOUBLE", {Kind::Float, 8}}};

/// The head, which ends with ElementDataFile; `begin` is where local data begin.
TextHeader read_meta_head(const std::string& content, const std::filesystem::path& file, std::size_t& begin) {
    TextHeader head(file);
    std::size_t at = 0;
    while (at < content.size() && !head.has("ElementDataFile")) {
        const std::size_t end = std::min(content.find('\n', at), content.size());
        const std::string line = content.substr(at, end - at);
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos && !trimmed(line).empty())
            throw InvalidInput(fmt::format("{}: {} is no line of a MetaImage's head ('Key = value'). Export it again.",
                                           file.string(), cited(line)));
        if (equals != std::string::npos) head.add(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
        at = end + 1;
    }
    begin = std::min(at, content.size());
    return head;
}

/// The value of the first of these keys that the head has.
std::string first_of(const TextHeader& head, std::initializer_list<const char*> keys, const std::string& fallback) {
    for (const char* key : keys)
        if (head.has(key)) return head.at(key);
    return fallback;
}

bool is_true(const std::string& word) { return in_lower_case(word) == "true" || word == "1"; }

/// A row of the matrix is the direction of an axis.
void place_meta(const TextHeader& head, LabelImage& image, const std::filesystem::path& file) {
    const auto directions =
        numbers_in(first_of(head, {"TransformMatrix", "Rotation", "Orientation"}, "1 0 0 0 1 0 0 0 1"), 9,
                   "'TransformMatrix'", file);
    const auto spacing =
        numbers_in(first_of(head, {"ElementSpacing", "ElementSize"}, "1 1 1"), 3, "'ElementSpacing'", file);
    const auto origin = numbers_in(first_of(head, {"Offset", "Position", "Origin"}, "0 0 0"), 3, "'Offset'", file);
    image.axes = Eigen::Map<const Mat3>(directions.data()) * Vec3(spacing[0], spacing[1], spacing[2]).asDiagonal();
    image.origin = Vec3(origin[0], origin[1], origin[2]);
}

}  // namespace

LabelImage read_meta_image(const std::filesystem::path& file) {
    const std::string content = read_text(file);
    std::size_t begin = 0;
    const TextHeader head = read_meta_head(content, file, begin);
    if (head.at("NDims") != "3" || head.value_or("ElementNumberOfChannels", "1") != "1")
        throw InvalidInput(fmt::format("{}: has {} dimensions and {} channel(s); 3 and 1 are allowed.", file.string(),
                                       cited(head.at("NDims")), head.value_or("ElementNumberOfChannels", "1")));
    LabelImage image;
    const auto sizes = numbers_in(head.at("DimSize"), 3, "'DimSize'", file);
    for (std::size_t d = 0; d < 3; ++d) image.size[d] = static_cast<std::int64_t>(std::clamp(sizes[d], -1.0, 1e12));
    const auto type = meta_types.find(head.at("ElementType"));
    if (type == meta_types.end())
        throw InvalidInput(fmt::format("{}: the element type {} is not known; MET_CHAR to MET_DOUBLE are allowed.",
                                       file.string(), cited(head.at("ElementType"))));
    image.type = type->second;
    image.type.is_swapped = is_true(first_of(head, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}, "False"));
    place_meta(head, image, file);
    const std::size_t bytes = checked_bytes(image, file);

    if (!is_true(head.value_or("BinaryData", "True")))
        throw InvalidInput(fmt::format("{}: its voxels are text; binary ones are allowed.", file.string()));
    const std::string name = head.at("ElementDataFile");
    const bool is_local = in_lower_case(name) == "local";
    const std::filesystem::path data_file = is_local ? file : beside(file, name);
    const std::string detached = is_local ? "" : read_text(data_file);
    const std::string_view data = is_local ? std::string_view(content).substr(begin) : std::string_view(detached);
    image.voxels = is_true(head.value_or("CompressedData", "False")) ? inflated(data, bytes, data_file)
                                                                     : as_stored(data, bytes, data_file);
    return image;
}

}  // namespace palpate::mesh
