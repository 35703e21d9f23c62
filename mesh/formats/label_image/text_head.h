#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace palpate::mesh {

/// The head of an image in text: a field a line, up to where the voxels begin.
class TextHeader {
public:
    explicit TextHeader(std::filesystem::path file) : file_(std::move(file)) {}

    void add(std::string key, std::string value) { fields_[std::move(key)] = std::move(value); }
    bool has(const std::string& key) const { return fields_.contains(key); }
    /// @throws InvalidInput when the field is not there.
    const std::string& at(const std::string& key) const;
    std::string value_or(const std::string& key, const std::string& fallback) const;

private:
    std::filesystem::path file_;
    std::map<std::string, std::string> fields_;
};

std::string trimmed(const std::string& text);
std::string in_lower_case(std::string text);

}  // namespace palpate::mesh
