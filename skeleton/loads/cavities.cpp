#include "skeleton/loads/cavities.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "mesh/topology/shells.h"

namespace palpate::skeleton {

namespace {

// Does every edge of these triangles have its other side among them?
bool is_closed(const mesh::Surface& surface, const std::vector<int>& triangles) {
    std::set<std::pair<int, int>> edges;
    for (const int t : triangles)
        for (int i = 0; i < 3; ++i) edges.emplace(surface.triangles(t, i), surface.triangles(t, (i + 1) % 3));
    for (const auto& [from, to] : edges)
        if (!edges.contains({to, from})) return false;
    return true;
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

using Corners = std::array<int, 3>;

// The walls of each cavity.
std::vector<std::vector<Corners>> walls_by_cavity(const Model& model) {
    std::vector<std::vector<Corners>> cavities;
    if (model.skin.empty()) return cavities;
    const std::vector<int> number = mesh::connected_parts(model.surface);
    std::vector<std::vector<int>> parts;
    for (int t = 0; t < static_cast<int>(number.size()); ++t) {
        if (number[t] >= static_cast<int>(parts.size())) parts.resize(number[t] + 1);
        parts[number[t]].push_back(t);
    }
    for (const std::vector<int>& part : parts) {
        if (!is_closed(model.surface, part) || !(enclosed(model.surface, part) < 0)) continue;
        std::vector<Corners>& walls = cavities.emplace_back();
        for (const int t : part) {
            const auto corners = model.surface.triangles.row(t);
            walls.push_back({corners[0], corners[1], corners[2]});
        }
    }
    return cavities;
}

double distance(const mesh::Surface& surface, const std::vector<Corners>& walls, const Vec3& point) {
    double least = INFINITY;
    for (const Corners& wall : walls)
        for (const int vertex : wall)
            least = std::min(least, (surface.vertices.row(vertex).transpose() - point).norm());
    return least;
}

std::vector<Corners> walls_of(const Model& model, const mesh::PressureActuator& actuator) {
    constexpr Eigen::Index most = 50;  // vertices of a surface that are asked
    std::vector<Corners> best;
    double nearest = INFINITY;
    for (const std::vector<Corners>& walls : walls_by_cavity(model)) {
        double sum = 0;
        if (const auto* point = std::get_if<Vec3>(&actuator.cavity)) {
            sum = distance(model.surface, walls, *point);
        } else {
            const Points& vertices = std::get<mesh::Surface>(actuator.cavity).vertices;
            const Eigen::Index stride = std::max<Eigen::Index>(1, vertices.rows() / most);
            for (Eigen::Index v = 0; v < vertices.rows(); v += stride)
                sum += distance(model.surface, walls, vertices.row(v));
        }
        if (sum < nearest) best = walls;
        nearest = std::min(nearest, sum);
    }
    return best;
}

}  // namespace

std::vector<std::array<int, 3>> cavity_walls(const Model& model) {
    std::vector<Corners> all;
    for (const std::vector<Corners>& walls : walls_by_cavity(model)) all.insert(all.end(), walls.begin(), walls.end());
    return all;
}

Cavities::Cavities(const Model& model) : Cavities(model, cavity_walls(model)) {}
Cavities::Cavities(const Model& model, const mesh::PressureActuator& actuator)
    : Cavities(model, walls_of(model, actuator)) {}

Cavities::Cavities(const Model& model, const std::vector<Corners>& walls) : rest_(rest_state(model)) {
    for (const Corners& wall : walls) {
        walls_.push_back({model.skin[wall[0]], model.skin[wall[1]], model.skin[wall[2]]});
        origin_ += model.surface.vertices.row(wall[0]).transpose();
    }
    if (walls_.empty()) return;
    origin_ /= static_cast<double>(walls_.size());
    rest_volume_ = volume(rest_);
    std::set<std::array<int, 2>> joined;
    for (const std::array<Attachment, 3>& wall : walls_)
        for (const Attachment& one : wall)
            for (const Attachment& other : wall)
                for (const SphereInfluence& a : one.shares)
                    for (const SphereInfluence& b : other.shares)
                        if (a.sphere < b.sphere) joined.insert({a.sphere, b.sphere});
    joined_.assign(joined.begin(), joined.end());
}

Cavities::Wall Cavities::at(const std::array<Attachment, 3>& wall, const State& state) const {
    return {CarriedPoint(wall[0], rest_, state), CarriedPoint(wall[1], rest_, state),
            CarriedPoint(wall[2], rest_, state)};
}

double Cavities::volume(const State& state) const {
    double sum = 0;
    for (const auto& wall : walls_) {
        const Wall x = at(wall, state);
        sum -= (x[0].x() - origin_).dot((x[1].x() - origin_).cross(x[2].x() - origin_)) / 6;
    }
    return sum;
}

void Cavities::add_gradient(const State& state, double factor, Eigen::VectorXd& sum) const {
    for (const auto& wall : walls_) {
        const Wall x = at(wall, state);
        for (int v = 0; v < 3; ++v) {
            const Vec3 by_x = (-factor / 6) * (x[(v + 1) % 3].x() - origin_).cross(x[(v + 2) % 3].x() - origin_);
            for (int i = 0; i < x[v].shares(); ++i)
                sum.segment<6>(Eigen::Index{6} * x[v].sphere(i)) += x[v].jacobian(i).transpose() * by_x;
        }
    }
}

}  // namespace palpate::skeleton
