#include "skeleton/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "pipeline/body/body.h"

namespace palpate::bench {
namespace {

/// The surface of those cells of a grid that `keep` holds for, by their middles [mm].
mesh::Surface carve(const Eigen::Vector3i& cells, double edge, const std::function<bool(const Vec3&)>& keep) {
    const auto is_body = [&](const Eigen::Vector3i& cell) {
        if ((cell.array() < 0).any() || (cell.array() >= cells.array()).any()) return false;
        return keep((cell.cast<double>() + Vec3::Constant(0.5)) * edge);
    };
    std::vector<Vec3> vertices;
    std::vector<Eigen::Vector3i> triangles;
    std::map<std::array<int, 3>, int> index;
    const auto vertex = [&](const Eigen::Vector3i& corner) {
        const auto [place, is_new] =
            index.try_emplace({corner.x(), corner.y(), corner.z()}, static_cast<int>(vertices.size()));
        if (is_new) vertices.push_back(corner.cast<double>() * edge);
        return place->second;
    };
    for (int n = 0; n < cells.prod(); ++n) {
        const Eigen::Vector3i cell(n % cells.x(), n / cells.x() % cells.y(), n / (cells.x() * cells.y()));
        for (int side = 0; side < 6 && is_body(cell); ++side) {
            const int axis = side / 2, up = side % 2;
            const Eigen::Vector3i out = Eigen::Vector3i::Unit(axis), a = Eigen::Vector3i::Unit((axis + 1) % 3),
                                  b = Eigen::Vector3i::Unit((axis + 2) % 3);
            if (is_body(cell + (2 * up - 1) * out)) continue;
            const Eigen::Vector3i corner = cell + up * out;
            const int p = vertex(corner), q = vertex(corner + (up == 1 ? a : b)), r = vertex(corner + a + b),
                      s = vertex(corner + (up == 1 ? b : a));
            triangles.emplace_back(p, q, r);
            triangles.emplace_back(p, r, s);
        }
    }
    mesh::Surface surface;
    surface.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
    surface.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t v = 0; v < vertices.size(); ++v) surface.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        surface.triangles.row(static_cast<Eigen::Index>(t)) = triangles[t];
    }
    return surface;
}

mesh::Surface tee() {
    // A stem of 70 along x, arms of 36 to both sides of its end, 16 thick.
    return carve({43, 44, 8}, 2, [](const Vec3& p) { return p.x() > 70 || std::abs(p.y() - 44) < 8; });
}

mesh::Surface bracket() {
    // Two plates of 8 at a right angle, 80 x 40 and 40 x 40, with a hole of 16 x 16 in the longer one.
    return carve({40, 20, 20}, 2, [](const Vec3& p) {
        const bool hole = std::abs(p.x() - 44) < 8 && std::abs(p.y() - 20) < 8;
        return (p.z() < 8 && !hole) || p.x() > 72;
    });
}

mesh::Surface ellipsoid() {
    mesh::Surface surface = mesh::make_sphere(Vec3::Zero(), 1, 4);
    surface.vertices *= Vec3(50, 35, 28).asDiagonal();
    return surface;
}

mesh::Surface from_file(const std::filesystem::path& file) {
    mesh::Surface surface = mesh::read_surface(file);
    surface.vertices *= 100 / mesh::bounding_box(surface.vertices).longest_side();
    return surface;
}

struct Recipe {
    std::string name;
    std::vector<int> spheres;
    std::function<mesh::Surface(const std::filesystem::path& meshes)> make;
};

/// At as many spheres as the targets of each kind of body are told for, and as by default.
const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all{
        {"bar",
         {0, 10},
         [](auto&) {
             return mesh::make_box({0, 0, 0}, {80, 20, 20}, {8, 2, 2});
         }},
        {"tee", {0, 30}, [](auto&) { return tee(); }},
        {"sheet",
         {0, 60},
         [](auto&) {
             return mesh::make_box({0, 0, 0}, {90, 60, 8}, {18, 12, 2});
         }},
        {"bracket", {0, 60}, [](auto&) { return bracket(); }},
        {"ellipsoid", {0, 60, 200}, [](auto&) { return ellipsoid(); }},
        {"liver2", {0, 60, 200}, [](auto& meshes) { return from_file(meshes / "liver2.obj"); }},
        {"starfish", {0, 40}, [](auto& meshes) { return from_file(meshes / "starfish.stl"); }},
        {"idler_riser", {0, 60, 200}, [](auto& meshes) { return from_file(meshes / "idler_riser.STL"); }},
    };
    return all;
}

}  // namespace

std::vector<std::string> body_names() {
    std::vector<std::string> names;
    for (const Recipe& recipe : recipes()) names.push_back(recipe.name);
    return names;
}

BenchBody make_bench_body(const std::string& name, const std::filesystem::path& meshes) {
    const auto recipe = std::ranges::find(recipes(), name, &Recipe::name);
    if (recipe == recipes().end()) {
        throw InvalidInput(fmt::format("there is no body '{}'; there are {}", name, fmt::join(body_names(), ", ")));
    }
    BenchBody body{name, recipe->spheres, {}};
    body.subject.surface = recipe->make(meshes);
    body.subject.supports = {pipeline::default_clamp(mesh::bounding_box(body.subject.surface.vertices))};
    body.subject.settings.name = name;
    return body;
}

}  // namespace palpate::bench
