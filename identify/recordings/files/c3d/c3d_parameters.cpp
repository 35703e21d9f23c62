#include "identify/recordings/files/c3d/c3d_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <utility>

#include "identify/recordings/files/text/cell.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

std::string in_large_letters(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

std::string without_padding(const std::string& text) {
    return std::string(trimmed(std::string_view(text).substr(0, text.find('\0'))));
}

/// The contents of a parameter: its type, its dimensions, its values.
C3dParameter read_parameter(const C3dBytes& bytes, std::size_t at, const std::string& name) {
    const auto type = static_cast<std::int8_t>(bytes.byte(at));
    const int dimensions = bytes.byte(at + 1);
    if (dimensions > 7)
        throw InvalidInput(
            fmt::format("{}: the parameter {} has {} dimensions; up to 7 are allowed. The file is broken: "
                        "export it again.",
                        bytes.name(), mesh::cited(name), dimensions));
    std::size_t count = 1;
    for (int d = 0; d < dimensions; ++d)
        count *= static_cast<std::size_t>(bytes.byte(at + 2 + static_cast<std::size_t>(d)));
    const std::size_t data = at + 2 + static_cast<std::size_t>(dimensions);
    const std::size_t size = type == 4 ? 4 : type == 2 ? 2 : 1;
    if (count > bytes.size() / size) bytes.require(data, bytes.size());
    bytes.require(data, count * size);

    C3dParameter parameter;
    if (type == -1) {
        const std::size_t length = dimensions == 0 ? 1 : static_cast<std::size_t>(bytes.byte(at + 2));
        for (std::size_t i = 0; length > 0 && i + length <= count; i += length)
            parameter.texts.push_back(without_padding(bytes.text(data + i, length)));
        return parameter;
    }
    parameter.numbers.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        parameter.numbers.push_back(type == 4   ? static_cast<double>(bytes.real(data + 4 * i))
                                    : type == 2 ? bytes.integer(data + 2 * i)
                                                : bytes.byte(data + i));
    return parameter;
}

}  // namespace

C3dParameters::C3dParameters(const C3dBytes& bytes) {
    std::map<int, std::string> groups;
    std::vector<std::pair<int, std::pair<std::string, C3dParameter>>> found;
    std::size_t at = bytes.parameters_at() + 4;
    // How long the section is stands before it, in blocks; in some files the last record's offset leads out of it.
    constexpr std::size_t block = 512;  // [bytes], of the format
    const auto blocks = static_cast<std::size_t>(bytes.byte(bytes.parameters_at() + 2));
    const std::size_t end = blocks > 0 ? bytes.parameters_at() + blocks * block : bytes.size();
    while (true) {
        // A record: length of the name (negative where it is locked), group (negative where it is one itself), name,
        // offset of the next record from here.
        const int length = std::abs(static_cast<std::int8_t>(bytes.byte(at)));
        if (length == 0) break;
        const auto id = static_cast<std::int8_t>(bytes.byte(at + 1));
        const std::string name = in_large_letters(bytes.text(at + 2, static_cast<std::size_t>(length)));
        const std::size_t after = at + 2 + static_cast<std::size_t>(length);
        const int next = bytes.word(after);
        if (id < 0)
            groups[-id] = name;
        else if (id > 0)
            found.push_back({id, {name, read_parameter(bytes, after + 2, name)}});
        if (next == 0) break;
        if (next < 2)
            throw InvalidInput(
                fmt::format("{}: after the parameter {} comes none, but {} bytes. The file is broken: export "
                            "it again.",
                            bytes.name(), mesh::cited(name), next));
        at = after + static_cast<std::size_t>(next);
        if (at >= end && end <= bytes.size()) break;
        if (at >= bytes.size()) bytes.require(at, 1);
    }
    for (auto& [id, named] : found)
        if (const auto group = groups.find(id); group != groups.end())
            parameters_[group->second + ":" + named.first] = std::move(named.second);
}

const C3dParameter* C3dParameters::find(const std::string& name) const {
    const auto found = parameters_.find(name);
    return found == parameters_.end() ? nullptr : &found->second;
}

double C3dParameters::number(const std::string& name, double otherwise) const {
    const C3dParameter* found = find(name);
    return found && !found->numbers.empty() ? found->numbers[0] : otherwise;
}

const std::vector<double>& C3dParameters::numbers(const std::string& name) const {
    static const std::vector<double> none;
    const C3dParameter* found = find(name);
    return found ? found->numbers : none;
}

std::string C3dParameters::text(const std::string& name) const {
    const C3dParameter* found = find(name);
    return found && !found->texts.empty() ? found->texts[0] : "";
}

std::vector<std::string> C3dParameters::texts(const std::string& name) const {
    std::vector<std::string> all;
    for (int part = 1;; ++part) {
        const C3dParameter* found = find(part == 1 ? name : fmt::format("{}{}", name, part));
        if (!found) return all;
        all.insert(all.end(), found->texts.begin(), found->texts.end());
    }
}

std::vector<double> C3dParameters::all_numbers(const std::string& name) const {
    std::vector<double> all;
    for (int part = 1;; ++part) {
        const C3dParameter* found = find(part == 1 ? name : fmt::format("{}{}", name, part));
        if (!found) return all;
        all.insert(all.end(), found->numbers.begin(), found->numbers.end());
    }
}

}  // namespace palpate::identify
