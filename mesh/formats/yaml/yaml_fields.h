#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mesh/types.h"

namespace palpate::mesh {

/// A mapping of a YAML file, read field by field; every message names file, line, field, value and what is allowed.
///
/// Fields that nobody asked for are an error (`finish`), with the nearest known name as a suggestion. Files above
/// 1 MiB, deeper than 32 levels, or with aliases are refused: none of ours needs them, and aliases make bombs.
class YamlFields {
public:
    /// @throws IoError, InvalidInput when the file is no YAML mapping.
    static YamlFields from_file(const std::filesystem::path& file);
    static YamlFields from_text(const std::string& text, const std::filesystem::path& name);

    bool has(const std::string& key) const;
    /// Does nothing stand there, or null?
    bool is_null(const std::string& key) const;
    std::string text(const std::string& key) const;
    /// One of `allowed`.
    std::string choice(const std::string& key, const std::vector<std::string>& allowed) const;
    double number(const std::string& key) const;
    /// A number in [least, most].
    double number(const std::string& key, double least, double most) const;
    int integer(const std::string& key, int least, int most) const;
    bool boolean(const std::string& key) const;
    Vec3 vector(const std::string& key) const;
    /// A list of vectors [x, y, z].
    std::vector<Vec3> vectors(const std::string& key) const;
    std::vector<double> numbers(const std::string& key) const;
    std::vector<std::string> texts(const std::string& key) const;
    YamlFields mapping(const std::string& key) const;
    /// A list of mappings.
    std::vector<YamlFields> mappings(const std::string& key) const;
    /// The same, or one mapping alone.
    std::vector<YamlFields> mapping_or_mappings(const std::string& key) const;

    /// @throws InvalidInput when a field of this mapping was never asked for; mappings inside it finish on their own.
    void finish() const;
    /// "case.yaml, line 4, noise", to begin a message with.
    std::string where(const std::string& key) const;
    const std::filesystem::path& file() const;

private:
    struct Impl;
    explicit YamlFields(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
    std::shared_ptr<Impl> impl_;
};

}  // namespace palpate::mesh
