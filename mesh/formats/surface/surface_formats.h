#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "mesh/formats/surface/polygons.h"

namespace palpate::mesh {

/// A kind of surface file. All that reads, writes, describes or lists surface files looks here.
struct SurfaceFormat {
    const char* extension;  // in lower case, with its dot
    Polygons (*read)(const std::string& content, const std::filesystem::path& file);
    void (*write)(const std::filesystem::path& file, const Surface& surface);  // null: is not written
};

/// All of them, in the order of messages.
std::span<const SurfaceFormat> surface_formats();

/// The one that the extension names, in letters of either case; null when none.
const SurfaceFormat* surface_format_of(const std::filesystem::path& file);

/// ".stl, .obj, ...", for a message: those that are read, and those that are written.
std::string surface_extensions();
std::string written_surface_extensions();

/// One reader a format; each takes the whole file. VTP is read by VTK, in a process of its own.
Polygons read_stl(const std::string& content, const std::filesystem::path& file);
Polygons read_obj(const std::string& content, const std::filesystem::path& file);
Polygons read_ply(const std::string& content, const std::filesystem::path& file);
Polygons read_off(const std::string& content, const std::filesystem::path& file);
Polygons read_vtp(const std::string& content, const std::filesystem::path& file);

/// One writer a format, whole or not at all. STL is binary, the others but VTP are text.
void write_stl(const std::filesystem::path& file, const Surface& surface);
void write_obj(const std::filesystem::path& file, const Surface& surface);
void write_ply(const std::filesystem::path& file, const Surface& surface);
void write_off(const std::filesystem::path& file, const Surface& surface);
void write_bare_vtp(const std::filesystem::path& file, const Surface& surface);

}  // namespace palpate::mesh
