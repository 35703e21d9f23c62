#include "skeleton/loads/cavity_walls.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/topology/shells.h"

namespace palpate::skeleton {
namespace {

// Is every edge of these triangles run through as often one way as the other?
bool is_closed(const mesh::Surface& surface, const std::vector<int>& triangles) {
    std::map<std::pair<int, int>, int> runs;  // of each edge, from its lesser vertex less from its greater one
    for (const int t : triangles) {
        for (int i = 0; i < 3; ++i) {
            const int from = surface.triangles(t, i), to = surface.triangles(t, (i + 1) % 3);
            runs[std::minmax(from, to)] += from < to ? 1 : -1;
        }
    }
    return !std::ranges::any_of(runs, [](const auto& edge) { return edge.second != 0; });
}

double enclosed(const mesh::Surface& surface, const std::vector<int>& triangles) {
    const Vec3 origin = surface.vertices.row(surface.triangles(triangles.front(), 0));
    double sum = 0;
    for (const int t : triangles) {
        const auto corner = [&](int i) -> Vec3 {
            return surface.vertices.row(surface.triangles(t, i)).transpose() - origin;
        };
        sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
    }
    return sum;
}

double distance(const mesh::Surface& surface, const CavityWall& wall, const Vec3& point) {
    double least = INFINITY;
    for (const auto& triangle : wall)
        for (const int vertex : triangle)
            least = std::min(least, (surface.vertices.row(vertex).transpose() - point).norm());
    return least;
}

}  // namespace

std::vector<CavityWall> walls_by_cavity(const Model& model) {
    std::vector<CavityWall> cavities;
    if (model.skin.empty()) return cavities;
    const std::vector<int> number = mesh::connected_parts(model.surface);
    std::vector<std::vector<int>> parts;
    for (int t = 0; t < static_cast<int>(number.size()); ++t) {
        if (number[t] >= static_cast<int>(parts.size())) parts.resize(number[t] + 1);
        parts[number[t]].push_back(t);
    }
    for (const std::vector<int>& part : parts) {
        if (!is_closed(model.surface, part) || !(enclosed(model.surface, part) < 0)) continue;
        CavityWall& wall = cavities.emplace_back();
        for (const int t : part) {
            const auto corners = model.surface.triangles.row(t);
            wall.push_back({corners[0], corners[1], corners[2]});
        }
    }
    return cavities;
}

int find_cavity(const Model& model, const std::vector<CavityWall>& cavities, const mesh::PressureActuator& actuator) {
    constexpr Eigen::Index most = 50;  // vertices of a surface that are asked
    int best = -1;
    double nearest = INFINITY;
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        double sum = 0;
        if (const auto* point = std::get_if<Vec3>(&actuator.cavity)) {
            sum = distance(model.surface, cavities[c], *point);
        } else {
            const Points& vertices = std::get<mesh::Surface>(actuator.cavity).vertices;
            const Eigen::Index stride = std::max<Eigen::Index>(1, vertices.rows() / most);
            for (Eigen::Index v = 0; v < vertices.rows(); v += stride)
                sum += distance(model.surface, cavities[c], vertices.row(v));
        }
        if (sum < nearest) best = static_cast<int>(c);
        nearest = std::min(nearest, sum);
    }
    return best;
}

}  // namespace palpate::skeleton
