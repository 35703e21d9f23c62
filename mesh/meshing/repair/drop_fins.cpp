#include "mesh/meshing/repair/drop_fins.h"

#include <map>
#include <utility>

namespace palpate::mesh {
namespace {

constexpr double most_area = 0.01;  // share

using EdgeUsers = std::map<std::pair<int, int>, std::vector<int>>;

EdgeUsers users_of_edges(const Surface& surface) {
    EdgeUsers users;
    for (int t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i)
            users[std::minmax(surface.triangles(t, i), surface.triangles(t, (i + 1) % 3))].push_back(t);
    return users;
}

/// The sheet of each triangle: sheets hang together by edges with two triangles.
std::vector<int> sheets_of(const Surface& surface, const EdgeUsers& users) {
    std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(surface.triangles.rows()));
    for (const auto& [edge, triangles] : users) {
        if (triangles.size() != 2) continue;
        neighbours[static_cast<std::size_t>(triangles[0])].push_back(triangles[1]);
        neighbours[static_cast<std::size_t>(triangles[1])].push_back(triangles[0]);
    }
    std::vector<int> sheet(neighbours.size(), -1);
    int count = 0;
    for (std::size_t start = 0; start < sheet.size(); ++start) {
        if (sheet[start] >= 0) continue;
        std::vector<int> waiting{static_cast<int>(start)};
        sheet[start] = count;
        while (!waiting.empty()) {
            const int t = waiting.back();
            waiting.pop_back();
            for (const int next : neighbours[static_cast<std::size_t>(t)]) {
                if (sheet[static_cast<std::size_t>(next)] >= 0) continue;
                sheet[static_cast<std::size_t>(next)] = count;
                waiting.push_back(next);
            }
        }
        ++count;
    }
    return sheet;
}

}  // namespace

Surface drop_fins(const Surface& surface, std::vector<Vec3>& dropped) {
    const EdgeUsers users = users_of_edges(surface);
    const std::vector<int> sheet = sheets_of(surface, users);
    struct Sheet {
        bool is_open = false, stands_on_edge = false;
        double area = 0;
        bool is_fin() const { return is_open && stands_on_edge; }
    };
    std::vector<Sheet> sheets(sheet.size());
    for (const auto& [edge, triangles] : users)
        for (const int t : triangles) {
            Sheet& of = sheets[static_cast<std::size_t>(sheet[static_cast<std::size_t>(t)])];
            of.is_open |= triangles.size() == 1;
            of.stands_on_edge |= triangles.size() > 2;
        }
    const Points vectors = area_vectors(surface);
    for (std::size_t t = 0; t < sheet.size(); ++t)
        sheets[static_cast<std::size_t>(sheet[t])].area += vectors.row(static_cast<Eigen::Index>(t)).norm();
    double fins = 0;
    for (const Sheet& one : sheets) fins += one.is_fin() ? one.area : 0;
    if (fins == 0 || fins > most_area * area(surface)) return surface;

    Surface result = surface;
    Eigen::Index count = 0;
    std::vector<char> is_used(static_cast<std::size_t>(surface.vertices.rows()), 0);
    for (std::size_t t = 0; t < sheet.size(); ++t) {
        if (sheets[static_cast<std::size_t>(sheet[t])].is_fin()) continue;
        result.triangles.row(count++) = surface.triangles.row(static_cast<Eigen::Index>(t));
        for (const int v : surface.triangles.row(static_cast<Eigen::Index>(t)))
            is_used[static_cast<std::size_t>(v)] = 1;
    }
    result.triangles.conservativeResize(count, 3);
    for (std::size_t v = 0; v < is_used.size(); ++v)
        if (!is_used[v]) dropped.emplace_back(surface.vertices.row(static_cast<Eigen::Index>(v)));
    return result;
}

}  // namespace palpate::mesh
