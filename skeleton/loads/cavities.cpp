#include "skeleton/loads/cavities.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "skeleton/loads/cavity_walls.h"

namespace palpate::skeleton {

namespace {

using Corners = std::array<int, 3>;

CavityWall wall_of(const Model& model, const mesh::PressureActuator& actuator) {
    const std::vector<CavityWall> cavities = walls_by_cavity(model);
    const int own = find_cavity(model, cavities, actuator);
    return own < 0 ? CavityWall() : cavities[own];
}

}  // namespace

std::vector<Corners> cavity_walls(const Model& model) {
    std::vector<Corners> all;
    for (const CavityWall& wall : walls_by_cavity(model)) all.insert(all.end(), wall.begin(), wall.end());
    return all;
}

Cavities::Cavities(const Model& model) : Cavities(model, cavity_walls(model)) {}
Cavities::Cavities(const Model& model, const mesh::PressureActuator& actuator)
    : Cavities(model, wall_of(model, actuator)) {}

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
