#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace palpate::mesh {

/// Runs what reads a VTK XML file that anybody may have written, in a child process first. @throws InvalidInput where
/// its head announces more than a file of this size can hold, a thousand entries a byte, or it breaks the reader.
void read_vtk(const std::filesystem::path& file, const std::function<void()>& read);
/// The same with the file's content.
void read_vtk(const std::filesystem::path& file, std::string_view content, const std::function<void()>& read);

}  // namespace palpate::mesh
