#include "mesh/formats/well_formed.h"

#include <fmt/format.h>

#include <vector>

#include "mesh/errors.h"

namespace palpate::mesh {
namespace {

/// The row of each vertex among those in use; -1: unused.
std::vector<int> rows_in_use(const Surface& surface, int& count) {
    std::vector<int> row(static_cast<std::size_t>(surface.vertices.rows()), -1);
    for (const int v : surface.triangles.reshaped()) row[static_cast<std::size_t>(v)] = 0;
    count = 0;
    for (int& r : row)
        if (r == 0) r = count++;
    return row;
}

void require_indices(const Surface& surface, const std::string& name) {
    if (surface.triangles.rows() == 0)
        throw InvalidInput(
            fmt::format("{}: the surface has no triangles. Give a surface that encloses a volume.", name));
    const Eigen::Index n = surface.vertices.rows();
    const int least = surface.triangles.minCoeff(), most = surface.triangles.maxCoeff();
    if (least < 0 || most >= n)
        throw InvalidInput(fmt::format("{}: a triangle names vertex {}; 0 to {} are allowed. Export the surface again.",
                                       name, least < 0 ? least : most, n - 1));
    for (const int v : surface.triangles.reshaped())
        if (!surface.vertices.row(v).allFinite())
            throw InvalidInput(
                fmt::format("{}: vertex {} is not finite. Remove it, or export the surface again.", name, v));
}

}  // namespace

void require_usable_size(const Points& points, const std::string& name) {
    if (points.rows() == 0) throw InvalidInput(fmt::format("{}: no vertex belongs to the body.", name));
    const double size = bounding_box(points).diagonal();
    if (size == 0)
        throw InvalidInput(fmt::format("{}: all its vertices are at one place; a body needs an extent.", name));
    if (!(size >= least_size && size <= largest_size))
        throw InvalidInput(fmt::format(
            "{}: the body spans {:.3g} in the file's unit; {:g} to {:g} are allowed. Export it in mm, or in "
            "another unit that --unit names.",
            name, size, least_size, largest_size));
    const double furthest = points.cwiseAbs().maxCoeff();
    if (size < least_share_of_coordinate * furthest)
        throw InvalidInput(fmt::format(
            "{}: the body spans {:.3g}, but lies {:.3g} away from the origin, where rounding eats its shape; at most "
            "{:g} times its size is allowed. Move it to the origin, and export it again.",
            name, size, furthest, 1 / least_share_of_coordinate));
}

Surface well_formed(const Surface& surface, const std::string& name, int* unused) {
    require_indices(surface, name);
    int used = 0;
    const std::vector<int> row = rows_in_use(surface, used);
    if (unused) *unused = static_cast<int>(surface.vertices.rows()) - used;
    Surface result{Points(used, 3), Triangles(surface.triangles.rows(), 3)};
    for (std::size_t v = 0; v < row.size(); ++v)
        if (row[v] >= 0) result.vertices.row(row[v]) = surface.vertices.row(static_cast<Eigen::Index>(v));
    for (Eigen::Index i = 0; i < surface.triangles.size(); ++i)
        result.triangles.data()[i] = row[static_cast<std::size_t>(surface.triangles.data()[i])];
    require_usable_size(result.vertices, name);
    const double negligible = negligible_coordinate * bounding_box(result.vertices).diagonal();
    result.vertices = (result.vertices.array().abs() < negligible).select(0, result.vertices);
    return result;
}

}  // namespace palpate::mesh
