#pragma once

#include <filesystem>

#include "mesh/formats/yaml/yaml_fields.h"

namespace palpate::identify {

inline constexpr const char* first_format_name = "palpate-measurements/1";
inline constexpr const char* second_format_name = "palpate-measurements/2";

/// @throws InvalidInput for a set of the first format that uses a part of the second, and for parts of the second that
/// are announced and cannot be fitted yet: each by its name, in set.yaml or as a file of its folder.
void check_parts(const mesh::YamlFields& set, bool is_first_format, const std::filesystem::path& folder);

}  // namespace palpate::identify
