#include "mesh/meshing/repair/cap_flat_holes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "mesh/formats/surface/polygons.h"

namespace palpate::mesh {
namespace {

constexpr double flatness = 0.005;  // share of the diagonal

/// The borders, each vertex followed by the one that a cap's triangles run to; those that meet themselves are left out.
std::vector<std::vector<int>> borders_of(const Surface& surface) {
    std::set<std::pair<int, int>> sides;
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) sides.emplace(t[i], t[(i + 1) % 3]);
    std::map<int, int> next;
    std::set<int> crowded;
    for (const auto& [a, b] : sides)
        if (!sides.contains({b, a}) && !next.try_emplace(b, a).second) crowded.insert(b);

    std::vector<std::vector<int>> borders;
    while (!next.empty()) {
        std::vector<int> border;
        bool is_simple = true;
        int vertex = next.begin()->first;
        for (auto at = next.find(vertex); at != next.end(); at = next.find(vertex)) {
            border.push_back(vertex);
            is_simple = is_simple && !crowded.contains(vertex);
            vertex = at->second;
            next.erase(at);
        }
        if (is_simple && border.size() > 2 && vertex == border.front()) borders.push_back(std::move(border));
    }
    return borders;
}

bool is_flat(const std::vector<Vec3>& corners, double allowed) {
    Vec3 center = Vec3::Zero(), normal = Vec3::Zero();
    for (const Vec3& corner : corners) center += corner / static_cast<double>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i)
        normal += (corners[i] - center).cross(corners[(i + 1) % corners.size()] - center);
    if (!(normal.norm() > 0)) return false;
    normal.normalize();
    return std::ranges::all_of(corners,
                               [&](const Vec3& corner) { return std::abs(normal.dot(corner - center)) <= allowed; });
}

}  // namespace

Surface cap_flat_holes(const Surface& surface, double largest) {
    const double diagonal = bounding_box(surface.vertices).diagonal();
    std::vector<Eigen::RowVector3i> caps;
    for (const std::vector<int>& border : borders_of(surface)) {
        const Points points = surface.vertices(border, Eigen::all);
        std::vector<Vec3> corners;
        for (const auto& point : points.rowwise()) corners.emplace_back(point.transpose());
        if (bounding_box(points).diagonal() > largest || !is_flat(corners, flatness * diagonal)) continue;
        const std::vector<int> ears = cut_ears(corners);
        for (std::size_t i = 0; i + 2 < ears.size(); i += 3)
            caps.emplace_back(border[static_cast<std::size_t>(ears[i])], border[static_cast<std::size_t>(ears[i + 1])],
                              border[static_cast<std::size_t>(ears[i + 2])]);
    }
    Surface result = surface;
    result.triangles.conservativeResize(surface.triangles.rows() + std::ssize(caps), 3);
    for (std::size_t i = 0; i < caps.size(); ++i)
        result.triangles.row(surface.triangles.rows() + static_cast<Eigen::Index>(i)) = caps[i];
    return result;
}

}  // namespace palpate::mesh
