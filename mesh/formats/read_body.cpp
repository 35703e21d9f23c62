#include "mesh/formats/read_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>

#include "mesh/errors.h"
#include "mesh/formats/cad/read_cad.h"
#include "mesh/formats/deck/deck.h"
#include "mesh/formats/label_image/label_surface.h"
#include "mesh/formats/solution/vtk_cells.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/formats/volume/elements.h"
#include "mesh/formats/volume/labelled_parts.h"
#include "mesh/formats/vtk/vtk_polygons.h"
#include "mesh/formats/well_formed.h"
#include "mesh/text/words.h"

namespace palpate::mesh {

namespace fs = std::filesystem;

namespace {

/// Parts are told apart by labels of elements or voxels alone.
void refuse_parts(const fs::path& file, const ReadBodyOptions& options) {
    if (options.parts.empty()) return;
    throw InvalidInput(
        fmt::format("{}: a file of this kind has no labels, so that label {} means nothing there. Labels are those of "
                    "an image of voxels, or materials of elements (.vtu, .msh, .mesh, .node, .ele); or give the "
                    "region's surface by 'surface'.",
                    file.string(), options.parts.front()));
}

BodyFile of_surface(const fs::path& file, const ReadBodyOptions& options) {
    refuse_parts(file, options);
    BodyFile body;
    int unused = 0;
    body.surface = well_formed(read_surface(file), file.string(), &unused);
    if (unused > 0)
        body.notes.push_back(fmt::format("{} that no triangle uses {} left out", count_of(unused, "vertex", "vertices"),
                                         unused == 1 ? "is" : "are"));
    return body;
}

template <Elements (*read)(const fs::path&)>
BodyFile of_elements(const fs::path& file, const ReadBodyOptions& options) {
    BodyFile body;
    const Elements elements = read(file);
    body.volume = assemble(elements, file, body.notes);
    if (options.parts.empty()) note_materials(elements, body.notes);
    body.surface = boundary_surface(*body.volume);
    body.parts = labelled_parts(*body.volume, elements.materials, options.parts, file);
    return body;
}

BodyFile of_deck(const fs::path& file, const ReadBodyOptions& options) {
    refuse_parts(file, options);
    BodyFile body;
    const Deck deck = read_deck(file);
    body.notes = deck.notes;
    body.volume = assemble(as_tetrahedra(deck.cells, body.notes), file, body.notes);
    body.surface = boundary_surface(*body.volume);
    body.files = deck.files;
    return body;
}

BodyFile of_tetgen(const fs::path& file, const ReadBodyOptions& options) {
    BodyFile body = of_elements<read_tetgen>(file, options);
    body.files = {tetgen_node_file(file), tetgen_element_file(file)};
    return body;
}

/// Tetrahedra where the file holds solid cells, else a surface.
BodyFile of_legacy_vtk(const fs::path& file, const ReadBodyOptions& options) {
    refuse_parts(file, options);
    BodyFile body;
    const VtkData data = read_vtk(file, VtkKind::legacy);
    if (std::ranges::all_of(data.types, is_flat)) {
        body.surface = triangulate(polygons_of(data), file);
        return body;
    }
    body.volume = assemble(as_tetrahedra(cells_of(data, file), body.notes), file, body.notes);
    body.surface = boundary_surface(*body.volume);
    return body;
}

BodyFile of_cad(const fs::path& file, const ReadBodyOptions& options) {
    refuse_parts(file, options);
    BodyFile body;
    body.surface = read_cad(file, body.notes);
    body.is_in_mm = true;
    return body;
}

template <LabelImage (*read)(const fs::path&)>
BodyFile of_labels(const fs::path& file, const ReadBodyOptions& options) {
    const LabelImage image = read(file);
    const auto labels = labels_of(image, file);
    BodyFile body;
    body.is_in_mm = true;
    if (options.parts.empty()) {
        body.surface = surface_of_label(image, choose_label(labels, options.label, image, file), body.notes);
        return body;
    }
    body.surface = surface_of_all_labels(image, body.notes);
    for (const int label : options.parts)
        body.parts.push_back(surface_of_label(image, choose_label(labels, label, image, file), body.notes));
    return body;
}

BodyFile of_points(const fs::path& file, const ReadBodyOptions&) {
    throw InvalidInput(fmt::format(
        "{}: a point cloud has no surface. Mesh the points first (for instance Poisson reconstruction in MeshLab or "
        "CloudCompare), and give the surface as one of {}.",
        file.string(), surface_extensions()));
}

struct BodyFormat {
    std::string_view extension;
    BodyFile (*read)(const fs::path& file, const ReadBodyOptions& options);
};

/// All but the surface files, which surface_formats() holds.
constexpr std::array body_formats{
    BodyFormat{".vtk", of_legacy_vtk},
    BodyFormat{".vtu", of_elements<read_vtu_elements>},
    BodyFormat{".msh", of_elements<read_gmsh>},
    BodyFormat{".mesh", of_elements<read_medit>},
    BodyFormat{".node", of_tetgen},
    BodyFormat{".ele", of_tetgen},
    BodyFormat{".inp", of_deck},
    BodyFormat{".step", of_cad},
    BodyFormat{".stp", of_cad},
    BodyFormat{".iges", of_cad},
    BodyFormat{".igs", of_cad},
    BodyFormat{".nii", of_labels<read_nifti>},
    BodyFormat{".nii.gz", of_labels<read_nifti>},
    BodyFormat{".nrrd", of_labels<read_nrrd>},
    BodyFormat{".nhdr", of_labels<read_nrrd>},
    BodyFormat{".mha", of_labels<read_meta_image>},
    BodyFormat{".mhd", of_labels<read_meta_image>},
    BodyFormat{".xyz", of_points},
    BodyFormat{".pcd", of_points},
    BodyFormat{".pts", of_points},
    BodyFormat{".las", of_points},
    BodyFormat{".laz", of_points},
    BodyFormat{".e57", of_points},
};

/// The format that the name ends with.
std::optional<BodyFormat> format_of(const fs::path& file) {
    std::string name = file.filename().string();
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto found = std::ranges::find_if(body_formats, [&](const BodyFormat& f) {
        return name.size() > f.extension.size() && name.ends_with(f.extension);
    });
    if (found != body_formats.end()) return *found;
    if (const SurfaceFormat* surface = surface_format_of(file)) return BodyFormat{surface->extension, of_surface};
    return std::nullopt;
}

}  // namespace

BodyFile read_body(const fs::path& file, const ReadBodyOptions& options) {
    const auto format = format_of(file);
    if (!format)
        throw InvalidInput(fmt::format("{}: the extension '{}' names no kind of body; allowed are {}.", file.string(),
                                       file.extension().string(), body_extensions()));
    BodyFile body = format->read(file, options);
    if (body.files.empty()) body.files = {file};
    return body;
}

bool is_body_file(const fs::path& file) { return format_of(file).has_value(); }

std::string body_name(const fs::path& file) {
    const auto format = format_of(file);
    const std::string name = file.filename().string();
    return format ? name.substr(0, name.size() - format->extension.size()) : file.stem().string();
}

std::string body_extensions() {
    return surface_extensions() +
           " (surfaces), .vtk (either), .vtu, .msh, .mesh, .node, .ele, .inp (tetrahedra), .step, .stp, .iges, .igs "
           "(CAD), .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd (labels of organs)";
}

}  // namespace palpate::mesh
