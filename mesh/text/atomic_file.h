#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace palpate::mesh {

/// Lets `write` fill a file beside `target` (same folder, same extension), then renames it over `target`: the
/// target appears whole or not at all. Missing parent folders are made.
/// @throws IoError when it cannot be written; nothing is left behind.
void write_whole(const std::filesystem::path& target,
                 const std::function<void(const std::filesystem::path& temporary)>& write);

/// The same for a text.
void write_text(const std::filesystem::path& target, const std::string& text);

/// @throws IoError when the file is missing or unreadable.
std::string read_text(const std::filesystem::path& file);

}  // namespace palpate::mesh
