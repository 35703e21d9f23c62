#pragma once

#include <array>
#include <vector>

#include "mesh/core/actuator.h"
#include "skeleton/model/carried_point.h"

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
    /// two spheres is their block (a, b). Order and spheres of the calls are the same in every state.
    template <typename Visit>
    void for_each_block(const State& state, const Visit& visit) const;

private:
    using Wall = std::array<CarriedPoint, 3>;
    Cavities(const Model& model, const std::vector<std::array<int, 3>>& walls);
    Wall at(const std::array<Attachment, 3>& wall, const State& state) const;

    State rest_;
    Vec3 origin_ = Vec3::Zero();                    // amid the walls, so that little is lost to rounding
    std::vector<std::array<Attachment, 3>> walls_;  // triangles, counter-clockwise seen from the body
    std::vector<std::array<int, 2>> joined_;
    double rest_volume_ = 0;
};

// A triangle's part in V is -1/6 x_0 . (x_1 x x_2), as its outward normal points into the cavity. By x_0 that is
// -1/6 x_1 x x_2, and by x_0, x_1 it is 1/6 [x_2]; the others follow in turn.
template <typename Visit>
void Cavities::for_each_block(const State& state, const Visit& visit) const {
    for (const auto& wall : walls_) {
        const Wall x = at(wall, state);
        for (int v = 0; v < 3; ++v) {
            const CarriedPoint &one = x[v], &next = x[(v + 1) % 3], &last = x[(v + 2) % 3];
            const Vec3 x_next = next.x() - origin_, x_last = last.x() - origin_;
            const Eigen::MatrixXd turning = one.curvature(-x_next.cross(x_last) / 6);
            for (int i = 0; i < one.shares(); ++i) {
                const int a = one.sphere(i);
                for (int j = 0; j < one.shares(); ++j)
                    if (a <= one.sphere(j)) visit(a, one.sphere(j), Block(turning.block<6, 6>(6 * i, 6 * j)));
                for (int j = 0; j < next.shares(); ++j) {
                    const int b = next.sphere(j);
                    const Block both = one.jacobian(i).transpose() * (skew(x_last) / 6) * next.jacobian(j);
                    if (a < b) visit(a, b, both);
                    if (a > b) visit(b, a, Block(both.transpose()));
                    if (a == b) visit(a, a, Block(both + both.transpose()));
                }
            }
        }
    }
}

}  // namespace palpate::skeleton
