#pragma once

#include <array>

#include "fem/effects/effects.h"
#include "skeleton/effects/placed_skin.h"
#include "skeleton/runtime/forces/carried.h"

namespace palpate::runtime {

/// Effects on points that the spheres carry, on the area of the skin, and pressure in its cavities. The laws are those
/// of skeleton::PlacedEffects.
class PointEffects {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    /// Keeps a reference to the model. @throws InvalidInput when it has nothing that one of them acts on.
    PointEffects(const skeleton::Model& model, const fem::Effects& effects);

    /// Spheres that support points hang on (flags, N).
    const std::vector<char>& supported() const { return supported_; }

    /// In all cavities, beside that of the effects [MPa]. @throws InvalidInput when the model has none.
    void set_pressure(double pressure);
    /// In one of them, in the order of skeleton::walls_by_cavity. @throws InvalidInput when there is no such one.
    void set_cavity_pressure(int cavity, double pressure);

    /// Adds their forces to the spheres' rows; returns their energy [N mm].
    double add_forces(const double* pose, double* force);

    /// Calls visit(a, b) with a <= b for each pair of spheres, in the order of for_each_block.
    template <typename Visit>
    void for_each_pair(const Visit& visit) const;
    /// Calls visit(block) with the second derivative of each pair, without the turning of the points' arms; of the
    /// skin's area and of pressure none.
    template <typename Visit>
    void for_each_block(const double* pose, const Visit& visit);

private:
    struct Placed {
        std::shared_ptr<const fem::PointPotential> potential;
        std::vector<RuntimePoint> points;
        std::vector<double> weights;
    };
    struct Cavity {
        std::vector<std::array<int, 3>> wall;  // by their corners
        std::vector<RuntimePoint> corners;
        std::vector<Vec3> growth;  // of the volume by each corner
        double rest_volume = 0;    // [mm^3]
        double pressure = 0;       // beside that of the effects [MPa]

        /// Volume as the spheres stand at `pose`, with the growth by each corner [mm^3].
        double place(const double* pose);
    };
    double add_skin(const double* pose, double* force);
    void take_cavities();
    double add_pressure(const double* pose, double* force);

    const skeleton::Model& model_;

    std::vector<Placed> effects_;
    std::vector<char> supported_;
    fem::SurfaceEnergies surface_;
    std::vector<skeleton::SkinTriangle> triangles_;  // where there are any
    std::vector<RuntimePoint> vertices_;             // of the skin
    std::vector<Vec3> pulls_;                        // on each of them [N]
    double of_effects_ = 0;                          // pressure in all cavities [MPa]
    std::vector<Cavity> cavities_;                   // where there was ever pressure
    std::vector<Eigen::Matrix<double, 3, 6>> by_share_;
};

template <typename Visit>
void PointEffects::for_each_pair(const Visit& visit) const {
    for (const Placed& effect : effects_) {
        for (const RuntimePoint& point : effect.points) {
            for (int i = 0; i < point.shares(); ++i) {
                for (int j = 0; j < point.shares(); ++j) {
                    if (point.sphere(i) <= point.sphere(j)) visit(point.sphere(i), point.sphere(j));
                }
            }
        }
    }
}

template <typename Visit>
void PointEffects::for_each_block(const double* pose, const Visit& visit) {
    for (Placed& effect : effects_) {
        for (std::size_t p = 0; p < effect.points.size(); ++p) {
            RuntimePoint& point = effect.points[p];
            point.place(pose);
            const Mat3 H = effect.weights[p] * effect.potential->terms(point.rest(), point.x()).hessian;
            const bool flat = H.isZero(0);
            if (!flat) point.jacobians(by_share_);
            for (int i = 0; i < point.shares(); ++i) {
                for (int j = 0; j < point.shares(); ++j) {
                    if (point.sphere(i) > point.sphere(j)) continue;
                    if (flat) {
                        visit(Block(Block::Zero()));
                    } else {
                        visit(Block(by_share_[i].transpose() * H * by_share_[j]));
                    }
                }
            }
        }
    }
}

}  // namespace palpate::runtime
