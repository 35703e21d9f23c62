#include "skeleton/loads/cavities.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

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
    std::map<int, int> place;  // among the points, of each vertex of the skin
    for (const Corners& wall : walls) {
        Corners& own = walls_.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [at, fresh] = place.try_emplace(wall[c], static_cast<int>(points_.size()));
            if (fresh) points_.push_back(model.skin[wall[c]]);
            own[c] = at->second;
        }
        origin_ += model.surface.vertices.row(wall[0]).transpose();
    }
    if (walls_.empty()) return;
    origin_ /= static_cast<double>(walls_.size());
    join_walls();
    rest_volume_ = volume(rest_);
}

/// As the walls close, each edge of one is run through the other way by another.
void Cavities::join_walls() {
    std::multimap<std::array<int, 2>, int> left_of;  // the corner across, of each edge as its wall runs round
    for (const Corners& wall : walls_)
        for (std::size_t c = 0; c < 3; ++c) left_of.emplace(std::array{wall[c], wall[(c + 1) % 3]}, wall[(c + 2) % 3]);
    std::set<std::array<int, 2>> joined;
    const auto join = [&](int p, int q) {
        for (const SphereInfluence& one : points_[p].shares)
            for (const SphereInfluence& other : points_[q].shares)
                if (one.sphere != other.sphere)
                    joined.insert({std::min(one.sphere, other.sphere), std::max(one.sphere, other.sphere)});
    };
    for (const auto& [edge, left] : left_of) {
        const auto [a, b] = edge;
        join(a, b);
        if (a > b) continue;
        const auto other = left_of.find({b, a});
        edges_.push_back({a, b, left, other->second});
        left_of.erase(other);
    }
    for (int p = 0; p < static_cast<int>(points_.size()); ++p) join(p, p);
    joined_.assign(joined.begin(), joined.end());
}

std::vector<CarriedPoint> Cavities::at(const State& state) const {
    std::vector<CarriedPoint> x;
    x.reserve(points_.size());
    for (const Attachment& point : points_) x.emplace_back(point, rest_, state);
    return x;
}

double Cavities::volume(const State& state) const {
    std::vector<Vec3> x;
    x.reserve(points_.size());
    for (const Attachment& point : points_) x.push_back(carried_place(point, rest_, state) - origin_);
    double sum = 0;
    for (const auto& [a, b, c] : walls_) sum -= x[a].dot(x[b].cross(x[c])) / 6;
    return sum;
}

Points Cavities::gradient(const std::vector<CarriedPoint>& x) const {
    Points by_x = Points::Zero(std::ssize(x), 3);
    for (const Corners& wall : walls_) {
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 next = x[wall[(c + 1) % 3]].x() - origin_, last = x[wall[(c + 2) % 3]].x() - origin_;
            by_x.row(wall[c]) -= next.cross(last).transpose() / 6;
        }
    }
    return by_x;
}

void Cavities::add_gradient(const State& state, double factor, Eigen::VectorXd& sum) const {
    const std::vector<CarriedPoint> x = at(state);
    const Points by_x = factor * gradient(x);
    for (std::size_t p = 0; p < x.size(); ++p) {
        const Vec3 own = by_x.row(static_cast<Eigen::Index>(p));
        for (int i = 0; i < x[p].shares(); ++i)
            sum.segment<6>(Eigen::Index{6} * x[p].sphere(i)) += x[p].jacobian(i).transpose() * own;
    }
}

}  // namespace palpate::skeleton
