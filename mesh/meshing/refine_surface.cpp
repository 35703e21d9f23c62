#include "mesh/meshing/refine_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <queue>
#include <vector>

namespace palpate::mesh {
namespace {

using Edge = std::array<int, 2>;

Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

class Refinement {
public:
    Refinement(const Surface& surface, const std::function<double(const Vec3&)>& edge_at) : edge_at_(edge_at) {
        for (const auto& vertex : surface.vertices.rowwise()) vertices_.emplace_back(vertex.transpose());
        for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
            triangles_.push_back({surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)});
            put_beside(static_cast<int>(t));
        }
        for (const auto& [edge, sides] : beside_) ask(edge);
    }

    void run() {
        while (!longest_.empty()) {
            const Edge edge = longest_.top().edge;
            longest_.pop();
            const auto found = beside_.find(edge);
            if (found != beside_.end()) halve(edge, found->second);
        }
    }

    Surface surface() const {
        Surface result;
        result.vertices.resize(std::ssize(vertices_), 3);
        for (std::size_t v = 0; v < vertices_.size(); ++v)
            result.vertices.row(static_cast<Eigen::Index>(v)) = vertices_[v];
        result.triangles.resize(std::ssize(triangles_), 3);
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (int c = 0; c < 3; ++c) result.triangles(static_cast<Eigen::Index>(t), c) = triangles_[t][c];
        return result;
    }

private:
    struct TooLong {
        double factor;
        Edge edge;
        // by the edge where factors are equal, so that the order is always the same
        bool operator<(const TooLong& other) const {
            return factor != other.factor ? factor < other.factor : edge > other.edge;
        }
    };

    void put_beside(int t) {
        const std::array<int, 3>& corners = triangles_[t];
        for (int c = 0; c < 3; ++c) beside_[edge_of(corners[c], corners[(c + 1) % 3])].push_back(t);
    }
    void take_away(int t) {
        const std::array<int, 3>& corners = triangles_[t];
        for (int c = 0; c < 3; ++c) std::erase(beside_[edge_of(corners[c], corners[(c + 1) % 3])], t);
    }
    void ask(const Edge& edge) {
        const Vec3 middle = (vertices_[edge[0]] + vertices_[edge[1]]) / 2;
        const double factor = (vertices_[edge[1]] - vertices_[edge[0]]).norm() / edge_at_(middle);
        if (factor > 1) longest_.push({factor, edge});
    }

    void halve(const Edge& edge, const std::vector<int>& sides_of_edge) {
        const std::vector<int> sides = sides_of_edge;  // as these change
        const auto middle = static_cast<int>(vertices_.size());
        vertices_.emplace_back((vertices_[edge[0]] + vertices_[edge[1]]) / 2);
        std::vector<Edge> fresh{edge_of(edge[0], middle), edge_of(edge[1], middle)};
        for (const int t : sides) {
            take_away(t);
            std::array<int, 3> other = triangles_[t];
            std::ranges::replace(triangles_[t], edge[1], middle);
            std::ranges::replace(other, edge[0], middle);
            triangles_.push_back(other);
            put_beside(t);
            put_beside(static_cast<int>(triangles_.size()) - 1);
            for (const int corner : other)
                if (corner != middle && corner != edge[1]) fresh.push_back(edge_of(corner, middle));
        }
        beside_.erase(edge);
        for (const Edge& one : fresh) ask(one);
    }

    const std::function<double(const Vec3&)>& edge_at_;
    std::vector<Vec3> vertices_;
    std::vector<std::array<int, 3>> triangles_;
    std::map<Edge, std::vector<int>> beside_;  // triangles of each edge
    std::priority_queue<TooLong> longest_;
};

}  // namespace

Surface refine_surface(const Surface& surface, const std::function<double(const Vec3&)>& edge_at) {
    Refinement refinement(surface, edge_at);
    refinement.run();
    return refinement.surface();
}

}  // namespace palpate::mesh
