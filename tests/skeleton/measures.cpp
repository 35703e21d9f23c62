#include "tests/skeleton/measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "mesh/topology/shells.h"

namespace palpate::skeleton {
namespace {

using Edges = std::set<std::pair<int, int>>;

double out_by(const mesh::SurfaceTree& tree, const Vec3& point) {
    return tree.inside(point) ? 0 : tree.closest(point).distance;
}

// The links, and the ground: held spheres are one piece with those that hold the same neighbour, and such pieces are
// one where the body leads straight from one to the other.
Edges edges_of(const Model& model, const mesh::SurfaceTree& tree) {
    Edges edges;
    std::vector<std::set<int>> around(model.spheres.size());
    for (const Link& link : model.links) {
        edges.insert(std::minmax(link.a, link.b));
        around[link.a].insert(link.b);
        around[link.b].insert(link.a);
    }
    const auto neighbors = [&](int i, int j) {
        return std::any_of(around[i].begin(), around[i].end(), [&](int k) { return around[j].contains(k); });
    };
    const auto straight = [&](int i, int j) {
        const Vec3 a = model.spheres[i].center, b = model.spheres[j].center;
        for (int k = 0; k <= 20; ++k) {
            if (out_by(tree, a + k * (b - a) / 20) > 0.1 * (b - a).norm()) return false;
        }
        return true;
    };
    std::vector<int> piece(model.spheres.size());
    std::iota(piece.begin(), piece.end(), 0);
    const auto join = [&](const auto& joined) {
        for (int i = 0; i < std::ssize(model.spheres); ++i) {
            for (int j = i + 1; j < std::ssize(model.spheres); ++j) {
                if (!model.spheres[i].held || !model.spheres[j].held || !joined(i, j)) continue;
                edges.emplace(i, j);
                std::replace(piece.begin(), piece.end(), int{piece[j]}, int{piece[i]});
            }
        }
    };
    join(neighbors);
    join([&](int i, int j) { return piece[i] != piece[j] && straight(i, j); });
    return edges;
}

int count_components(std::size_t nodes, const Edges& edges) {
    std::vector<int> parent(nodes);
    for (std::size_t i = 0; i < nodes; ++i) parent[i] = static_cast<int>(i);
    const auto root = [&](int i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (const auto& [a, b] : edges) parent[root(a)] = root(b);
    int count = 0;
    for (std::size_t i = 0; i < nodes; ++i) count += parent[i] == static_cast<int>(i);
    return count;
}

using Triangle = std::array<int, 3>;

// The triangles of edges that lie in the body, within a tenth of their shortest side: the others lie round a hole. A
// quadrangle of edges without diagonals that lies inside is two of them, and gets a diagonal.
std::vector<Triangle> triangles_of(const Model& model, const mesh::SurfaceTree& tree, Edges& edges) {
    std::vector<std::set<int>> around(model.spheres.size());
    for (const auto& [a, b] : edges) {
        around[a].insert(b);
        around[b].insert(a);
    }
    const auto at = [&](int i) { return model.spheres[i].center; };
    const auto lies_inside = [&](int a, int b, int c) {
        const double shortest = std::min({(at(a) - at(b)).norm(), (at(b) - at(c)).norm(), (at(c) - at(a)).norm()});
        constexpr int samples = 6;
        for (int i = 0; i <= samples; ++i) {
            for (int j = 0; i + j <= samples; ++j) {
                const Vec3 x = (i * at(a) + j * at(b) + (samples - i - j) * at(c)) / samples;
                if (out_by(tree, x) > 0.1 * shortest) return false;
            }
        }
        return true;
    };
    std::vector<Triangle> triangles;
    for (const auto& [a, b] : edges) {
        for (int c : around[b]) {
            if (c > b && around[a].contains(c) && lies_inside(a, b, c)) triangles.push_back({a, b, c});
        }
    }
    Edges diagonals;
    for (int a = 0; a < std::ssize(around); ++a) {
        for (int b : around[a]) {
            for (int c : around[b]) {
                if (c <= a || around[a].contains(c)) continue;
                for (int d : around[c]) {
                    if (d <= b || !around[a].contains(d) || around[b].contains(d) || diagonals.contains({b, d}))
                        continue;
                    if (!lies_inside(a, b, c) || !lies_inside(a, c, d)) continue;
                    diagonals.emplace(a, c);
                    triangles.push_back({a, std::min(b, c), std::max(b, c)});
                    triangles.push_back({a, std::min(c, d), std::max(c, d)});
                }
            }
        }
    }
    edges.merge(diagonals);
    for (Triangle& t : triangles) std::sort(t.begin(), t.end());
    return triangles;
}

// Rank of the boundary of the triangles over the field of two elements, by columns with distinct lowest edges.
int rank_of(const std::vector<Triangle>& triangles, const Edges& edges) {
    std::map<std::pair<int, int>, int> index;
    for (const auto& edge : edges) index.emplace(edge, std::ssize(index));
    std::map<int, std::vector<int>> reduced;
    for (const auto& [a, b, c] : triangles) {
        std::vector<int> column{index.at({a, b}), index.at({a, c}), index.at({b, c})};
        std::sort(column.begin(), column.end());
        while (!column.empty()) {
            const auto found = reduced.find(column.back());
            if (found == reduced.end()) break;
            std::vector<int> sum;
            std::set_symmetric_difference(column.begin(), column.end(), found->second.begin(), found->second.end(),
                                          std::back_inserter(sum));
            column = std::move(sum);
        }
        if (!column.empty()) reduced.emplace(column.back(), column);
    }
    return static_cast<int>(reduced.size());
}

}  // namespace

Measures measure(const Model& model, const mesh::SurfaceTree& tree) {
    Measures found;
    std::vector<int> degree(model.spheres.size());
    std::set<std::pair<int, int>> seen;
    for (const Link& link : model.links) {
        ++degree[link.a];
        ++degree[link.b];
        found.duplicates += link.a == link.b || !seen.insert(std::minmax(link.a, link.b)).second;
        const Vec3 &a = model.spheres[link.a].center, &b = model.spheres[link.b].center;
        constexpr int samples = 20;
        for (int i = 0; i <= samples; ++i)
            found.worst_link = std::max(found.worst_link, out_by(tree, a + i * (b - a) / samples));
    }
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const bool held = model.spheres[i].held;
        (held ? found.held : found.free) += 1;
        if (held) continue;
        found.tips += degree[i] == 1;
        found.worst_center = std::max(found.worst_center, out_by(tree, model.spheres[i].center));
    }
    found.links = static_cast<int>(model.links.size());
    Edges edges = edges_of(model, tree);
    const std::vector<Triangle> triangles = triangles_of(model, tree, edges);
    found.components = count_components(model.spheres.size(), edges);
    found.loops =
        static_cast<int>(std::ssize(edges) - std::ssize(model.spheres)) + found.components - rank_of(triangles, edges);

    for (Eigen::Index v = 0; v < model.surface.vertices.rows(); ++v) {
        const Vec3 vertex = model.surface.vertices.row(v);
        if (mesh::contains(model.supports, vertex)) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const Sphere& s : model.spheres) least = std::min(least, (vertex - s.center).norm() - s.radius);
        found.coverage = std::max(found.coverage, least);
    }
    return found;
}

double asymmetry(const Model& model, const Vec3& normal, const Vec3& middle) {
    const auto nearest = [&](const Vec3& point, const Sphere* but) {
        double least = std::numeric_limits<double>::infinity();
        for (const Sphere& s : model.spheres) {
            if (&s != but) least = std::min(least, (s.center - point).norm());
        }
        return least;
    };
    double squares = 0, apart = 0;
    int count = 0;
    for (const Sphere& s : model.spheres) {
        if (s.held) continue;
        const Vec3 image = s.center - 2 * normal.dot(s.center - middle) * normal;
        squares += std::pow(nearest(image, nullptr), 2);
        apart += nearest(s.center, &s);
        ++count;
    }
    return std::sqrt(squares / count) / (apart / count);
}

int handles(const mesh::Surface& surface) {
    int sum = 0;
    for (const mesh::Surface& part : mesh::split_parts(surface)) {
        // Closed: three half edges a triangle. V - E + F = 2 - 2 genus.
        const Eigen::Index F = part.triangles.rows();
        sum += static_cast<int>(2 - (part.vertices.rows() - F / 2)) / 2;
    }
    return sum;
}

}  // namespace palpate::skeleton
