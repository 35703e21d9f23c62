#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "identify/recordings/files/text/decoding/text_file.h"

namespace palpate::identify {

/// @throws IoError; InvalidInput where the file is no text.
std::unique_ptr<TextFile> open_text(const std::filesystem::path& file, const FileMap& map);

/// The same of bytes that were read already; none where they are no text.
std::unique_ptr<TextFile> try_text(const std::filesystem::path& file, const std::string& bytes, const FileMap& map);

/// A file beside another one, as a map names it. @throws InvalidInput where it lies elsewhere.
std::filesystem::path file_beside(const std::filesystem::path& file, const std::string& name);

}  // namespace palpate::identify
