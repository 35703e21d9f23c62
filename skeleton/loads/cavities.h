#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mesh/core/actuator.h"
#include "skeleton/model/attachment/carried_point.h"

namespace palpate::skeleton {

/// The triangles of the walls of a skin's closed cavities, by their corners on it, counter-clockwise seen from the
/// body.
std::vector<std::array<int, 3>> cavity_walls(const Model& model);

/// What a skeleton's skin encloses: the volume V of its closed cavities, as the spheres carry their walls, and its
/// derivatives by a step. A cavity is a part of the skin, joined at edges and without a border, that encloses a
/// negative volume by its outward orientation.
class Cavities {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    Cavities() = default;
    explicit Cavities(const Model& model);
    /// The one that an actuator means: that with a wall nearest to the point, or nearest in the mean to the vertices of
    /// the surface; none where there are none.
    Cavities(const Model& model, const mesh::PressureActuator& actuator);

    bool empty() const { return walls_.empty(); }
    double volume(const State& state) const;             // [mm^3]
    double rest_volume() const { return rest_volume_; }  // [mm^3]
    /// The spheres that walls join, a < b.
    const std::vector<std::array<int, 2>>& joined() const { return joined_; }
    /// Adds `factor` dV / d step to `sum` (6N).
    void add_gradient(const State& state, double factor, Eigen::VectorXd& sum) const;
    /// d^2 V / d step^2 in exponential coordinates: calls visit(a, b, block) with a <= b, whose sum over all calls of
    /// two spheres is their block (a, b).
    template <typename Visit>
    void for_each_block(const State& state, const Visit& visit) const;
    /// Calls visit(a, b) for the spheres of each of those calls, in their order, which is the same in every state.
    template <typename Visit>
    void for_each_pair(const Visit& visit) const;

private:
    /// An edge between two walls, and the vertices across it: that to its left as it runs from a to b, and the other.
    struct Edge {
        int a, b, left, right;
    };
    Cavities(const Model& model, const std::vector<std::array<int, 3>>& walls);
    void join_walls();
    std::vector<CarriedPoint> at(const State& state) const;
    /// Each vertex's part in dV/dx: minus a sixth of the cross product of the two others, summed over its walls.
    Points gradient(const std::vector<CarriedPoint>& x) const;

    State rest_;
    Vec3 origin_ = Vec3::Zero();             // amid the walls, so that little is lost to rounding
    std::vector<Attachment> points_;         // the walls' vertices
    std::vector<std::array<int, 3>> walls_;  // by their corners among these, counter-clockwise seen from the body
    std::vector<Edge> edges_;
    std::vector<std::array<int, 2>> joined_;
    double rest_volume_ = 0;
};

template <typename Visit>
void Cavities::for_each_pair(const Visit& visit) const {
    for (const Attachment& point : points_)
        for (const SphereInfluence& one : point.shares)
            for (const SphereInfluence& other : point.shares)
                if (one.sphere <= other.sphere) visit(one.sphere, other.sphere);
    for (const Edge& edge : edges_)
        for (const SphereInfluence& one : points_[edge.a].shares)
            for (const SphereInfluence& other : points_[edge.b].shares)
                visit(std::min(one.sphere, other.sphere), std::max(one.sphere, other.sphere));
}

// A wall's part in V is -1/6 x_0 . (x_1 x x_2), as its outward normal points into the cavity. By x_0 that is
// -1/6 x_1 x x_2, and by x_0, x_1 it is 1/6 [x_2]: of an edge from a to b, 1/6 [x_left - x_right].
template <typename Visit>
void Cavities::for_each_block(const State& state, const Visit& visit) const {
    const std::vector<CarriedPoint> x = at(state);
    const Points by_x = gradient(x);
    for (std::size_t p = 0; p < x.size(); ++p) {
        const Eigen::MatrixXd turning = x[p].curvature(by_x.row(static_cast<Eigen::Index>(p)));
        for (int i = 0; i < x[p].shares(); ++i)
            for (int j = 0; j < x[p].shares(); ++j)
                if (x[p].sphere(i) <= x[p].sphere(j))
                    visit(x[p].sphere(i), x[p].sphere(j), Block(turning.block<6, 6>(6 * i, 6 * j)));
    }
    for (const Edge& edge : edges_) {
        const CarriedPoint &from = x[edge.a], &to = x[edge.b];
        const Mat3 across = skew(x[edge.left].x() - x[edge.right].x()) / 6;
        for (int i = 0; i < from.shares(); ++i) {
            const Eigen::Matrix<double, 6, 3> along = from.jacobian(i).transpose() * across;
            const int a = from.sphere(i);
            for (int j = 0; j < to.shares(); ++j) {
                const int b = to.sphere(j);
                const Block both = along * to.jacobian(j);
                if (a < b) visit(a, b, both);
                if (a > b) visit(b, a, Block(both.transpose()));
                if (a == b) visit(a, a, Block(both + both.transpose()));
            }
        }
    }
}

}  // namespace palpate::skeleton
