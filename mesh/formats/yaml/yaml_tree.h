#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::mesh {

/// A YAML document as read: scalars are still text, and every node knows its line.
struct YamlNode {
    enum class Kind { empty, scalar, sequence, mapping };
    Kind kind = Kind::empty;
    int line = 0;                     // of the file, from 1
    std::string value{};              // of a scalar
    std::vector<std::string> keys{};  // of a mapping, one for each item
    std::vector<int> key_lines{};     // where each key stands
    std::vector<YamlNode> items{};    // of a sequence or mapping
};

/// The one document of a text; `name` is the file's, for messages.
/// @throws InvalidInput for what is no YAML, for several documents, repeated keys, aliases, more than 32 levels.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& name);

}  // namespace palpate::mesh
