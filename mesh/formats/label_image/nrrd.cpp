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

/// [Definition of NRRD file format, section "Basic field specifications"]
const std::map<std::string, VoxelType> nrrd_types{{"signed char", {Kind::Signed, 1}},
                                                  {"int8", {Kind::Signed, 1}},
                                                  {"int8_t", {Kind::Signed, 1}},
                                                  {"uchar", {Kind::Unsigned, 1}},
                                                  {"unsigned char", {Kind::Unsigned, 1}},
                                                  {"uint8", {Kind::Unsigned, 1}},
                                                  {"uint8_t", {Kind::Unsigned, 1}},
                                                  {"short", {Kind::Signed, 2}},
                                                  {"short int", {Kind::Signed, 2}},
                                                  {"signed short", {Kind::Signed, 2}},
                                                  {"int16", {Kind::Signed, 2}},
                                                  {"int16_t", {Kind::Signed, 2}},
                                                  {"ushort", {Kind::Unsigned, 2}},
                                                  {"unsigned short", {Kind::Unsigned, 2}},
                                                  {"uint16", {Kind::Unsigned, 2}},
                                                  {"uint16_t", {Kind::Unsigned, 2}},
                                                  {"int", {Kind::Signed, 4}},
                                                  {"signed int", {Kind::Signed, 4}},
                                                  {"int32", {Kind::Signed, 4}},
                                                  {"int32_t", {Kind::Signed, 4}},
                                                  {"uint", {Kind::Unsigned, 4}},
                                                  {"unsigned int", {Kind::Unsigned, 4}},
                                                  {"uint32", {Kind::Unsigned, 4}},
                                                  {"uint32_t", {Kind::Unsigned, 4}},
                                                  {"int64", {Kind::Signed, 8}},
                                                  {"uint64", {Kind::Unsigned, 8}},
                                                  {"float", {Kind::Float, 4}},
                                                  {"double", {Kind::Float, 8}}};

/// The head, up to its blank line; `begin` is where the data begin.
TextHeader read_nrrd_head(const std::string& content, const std::filesystem::path& file, std::size_t& begin) {
    if (!content.starts_with("NRRD000"))
        throw InvalidInput(fmt::format("{}: does not begin with NRRD000. Export it as NRRD.", file.string()));
    TextHeader head(file);
    std::size_t at = content.find('\n');
    while (at < content.size()) {
        const std::size_t end = std::min(content.find('\n', at + 1), content.size());
        const std::string line = trimmed(content.substr(at + 1, end - at - 1));
        at = end;
        if (line.empty()) break;
        const std::size_t colon = line.find(": ");
        if (line[0] == '#' || colon == std::string::npos) continue;
        head.add(in_lower_case(line.substr(0, colon)), trimmed(line.substr(colon + 2)));
    }
    begin = std::min(at + 1, content.size());
    return head;
}

void place_nrrd(const TextHeader& head, LabelImage& image, const std::filesystem::path& file) {
    if (head.has("space directions")) {
        const auto numbers = numbers_in(head.at("space directions"), 9, "'space directions'", file);
        image.axes = Eigen::Map<const Mat3>(numbers.data());
    } else if (head.has("spacings")) {
        const auto numbers = numbers_in(head.at("spacings"), 3, "'spacings'", file);
        image.axes = Vec3(numbers[0], numbers[1], numbers[2]).asDiagonal();
    }
    if (head.has("space origin")) {
        const auto numbers = numbers_in(head.at("space origin"), 3, "'space origin'", file);
        image.origin = Vec3(numbers[0], numbers[1], numbers[2]);
    }
}

/// The data, of which the head may leave out lines and bytes.
std::string_view behind_skips(std::string_view data, const TextHeader& head, const std::filesystem::path& file) {
    const double lines =
        numbers_in(head.value_or("line skip", head.value_or("lineskip", "0")), 1, "'line skip'", file)[0];
    const double bytes =
        numbers_in(head.value_or("byte skip", head.value_or("byteskip", "0")), 1, "'byte skip'", file)[0];
    for (int i = 0; i < lines && !data.empty(); ++i) data.remove_prefix(std::min(data.find('\n'), data.size() - 1) + 1);
    if (bytes > 0) data.remove_prefix(std::min(static_cast<std::size_t>(bytes), data.size()));
    return data;
}

/// Numbers as words, put down as the type stores them.
std::string from_words(std::string_view words, const LabelImage& image, const std::filesystem::path& file) {
    const auto values = numbers_in(words, static_cast<std::size_t>(image.count()), "the data", file);
    std::string bytes;
    for (const double value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return bytes;
}

}  // namespace

LabelImage read_nrrd(const std::filesystem::path& file) {
    const std::string content = read_text(file);
    std::size_t begin = 0;
    const TextHeader head = read_nrrd_head(content, file, begin);
    if (head.at("dimension") != "3")
        throw InvalidInput(fmt::format("{}: has the dimension {}; 3 is allowed. Export one layer of labels.",
                                       file.string(), cited(head.at("dimension"))));
    LabelImage image;
    const auto sizes = numbers_in(head.at("sizes"), 3, "'sizes'", file);
    for (std::size_t d = 0; d < 3; ++d) image.size[d] = static_cast<std::int64_t>(std::clamp(sizes[d], -1.0, 1e12));
    const auto type = nrrd_types.find(in_lower_case(head.at("type")));
    if (type == nrrd_types.end())
        throw InvalidInput(fmt::format("{}: the type {} is not known; int8 to uint64, float and double are allowed.",
                                       file.string(), cited(head.at("type"))));
    image.type = type->second;
    image.type.is_swapped = in_lower_case(head.value_or("endian", "little")) == "big";
    place_nrrd(head, image, file);
    const std::size_t bytes = checked_bytes(image, file);

    const std::string other = head.value_or("data file", head.value_or("datafile", ""));
    const std::filesystem::path data_file = other.empty() ? file : beside(file, other);
    const std::string detached = other.empty() ? "" : read_text(data_file);
    const std::string_view data =
        behind_skips(other.empty() ? std::string_view(content).substr(begin) : std::string_view(detached), head, file);
    const std::string encoding = in_lower_case(head.at("encoding"));
    if (encoding == "raw") {
        image.voxels = as_stored(data, bytes, data_file);
    } else if (encoding == "gzip" || encoding == "gz") {
        image.voxels = inflated(data, bytes, data_file);
    } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
        image.voxels = from_words(data, image, data_file);
        image.type = {Kind::Float, 8};
    } else {
        throw InvalidInput(fmt::format("{}: the encoding {} is not known; raw, gzip and ascii are allowed.",
                                       file.string(), cited(encoding)));
    }
    return image;
}

}  // namespace palpate::mesh
