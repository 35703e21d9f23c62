#pragma once

#include <filesystem>

namespace palpate::mesh {

/// A name beside the target, with its extension, that no other thread or program uses: for what gets the target's name
/// when it is finished.
std::filesystem::path unfinished_beside(const std::filesystem::path& target);

/// Is this a name that unfinished_beside gave? What stands there after its program has ended was never finished.
bool is_unfinished(const std::filesystem::path& path);

}  // namespace palpate::mesh
