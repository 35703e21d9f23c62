#pragma once

#include <array>
#include <vector>

#include "fem/effects/surface/facet.h"
#include "skeleton/model/attachment/carried_point.h"

namespace palpate::skeleton {

/// A triangle of a skin, by the numbers of its corners, and how it rests.
struct SkinTriangle {
    std::array<int, 3> corners;
    fem::FacetPoint<3> at_rest;
};

/// A skin's triangles, but for those without area. @throws InvalidInput when the model has no skin.
std::vector<SkinTriangle> skin_triangles(const Model& model);

/// Energies of the area of a skeleton's skin, whose triangles stay flat, and their derivatives by a step.
class PlacedSkin {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    PlacedSkin() = default;
    /// @throws InvalidInput when there are effects, and no skin.
    PlacedSkin(const Model& model, fem::SurfaceEnergies effects);

    bool empty() const { return effects_.empty(); }
    double energy(const State& state) const;  // [N mm]
    /// Adds `factor` d energy / d step to `sum` (6N).
    void add_gradient(const State& state, double factor, Eigen::VectorXd& sum) const;
    /// d^2 energy / d step^2 in exponential coordinates: calls visit(a, b, block) with a <= b, whose sum over all calls
    /// of two spheres is their block (a, b). Order and spheres of the calls are the same in every state.
    template <typename Visit>
    void for_each_block(const State& state, const Visit& visit) const;

private:
    struct Triangle {
        std::array<Attachment, 3> corners;
        fem::FacetPoint<3> at_rest;
    };
    using Corners = std::array<CarriedPoint, 3>;
    Corners at(const Triangle& triangle, const State& state) const;
    fem::FacetEnergy<3> energy(const Triangle& triangle, const Corners& x) const;

    State rest_;
    fem::SurfaceEnergies effects_;
    std::vector<Triangle> triangles_;
};

template <typename Visit>
void PlacedSkin::for_each_block(const State& state, const Visit& visit) const {
    for (const Triangle& triangle : triangles_) {
        const Corners x = at(triangle, state);
        const fem::FacetEnergy<3> own = energy(triangle, x);
        for (int v = 0; v < 3; ++v) {
            // by how the corner's motion turns, and by the motions themselves
            const Eigen::MatrixXd turning = x[v].curvature(own.by_node(v));
            for (int i = 0; i < x[v].shares(); ++i) {
                for (int j = 0; j < x[v].shares(); ++j) {
                    if (x[v].sphere(i) <= x[v].sphere(j))
                        visit(x[v].sphere(i), x[v].sphere(j), Block(turning.block<6, 6>(6 * i, 6 * j)));
                }
            }
            for (int u = 0; u < 3; ++u) {
                const Mat3 H = own.by_nodes(v, u);
                for (int i = 0; i < x[v].shares(); ++i) {
                    const Eigen::Matrix<double, 6, 3> along = x[v].jacobian(i).transpose() * H;
                    for (int j = 0; j < x[u].shares(); ++j) {
                        if (x[v].sphere(i) <= x[u].sphere(j))
                            visit(x[v].sphere(i), x[u].sphere(j), Block(along * x[u].jacobian(j)));
                    }
                }
            }
        }
    }
}

}  // namespace palpate::skeleton
