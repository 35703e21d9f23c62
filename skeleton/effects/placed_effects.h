#pragma once

#include <array>
#include <vector>

#include "fem/effects/effects.h"
#include "skeleton/effects/placed_skin.h"
#include "skeleton/effects/point_sets.h"
#include "skeleton/loads/cavities.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// Effects in force on a skeleton that are not in its links: potentials on points that its spheres carry, energies of
/// its skin's area, and pressure in the cavities of its skin,
///   Pi = sum_i w_i e(X_i, p_i) + sum_t A_t w(X_t, J_t) - pressure V,  p = sum_s share_s (x_s + R_s r_s),
/// so their forces are minus a derivative, as the links' are. By the linear law pressure is a dead load, as it is at
/// rest. Those that hold the body at its supports take the place of these: held spheres that are linked are free then.
class PlacedEffects {
public:
    using Block = Eigen::Matrix<double, 6, 6>;
    struct Energy {
        double sum = 0;   // [N mm]
        double size = 0;  // sum of the points' magnitudes, which tells how well the other is known [N mm]
    };

    /// @throws InvalidInput when the model has nothing that one of them acts on.
    PlacedEffects(const Model& model, const fem::Effects& effects);

    bool empty() const { return effects_.empty() && skin_.empty() && pressure_ == 0; }
    bool release_supports() const;
    /// Spheres that support points hang on (flags, N).
    const std::vector<char>& supported() const { return supported_; }

    /// `share`, here and below, scales the effects that hold no support: a load that is put on step by step.
    Energy energy(const State& state, double share = 1) const;
    /// - d energy / d step (6N) [N, N mm].
    Eigen::VectorXd force(const State& state, double share = 1) const;

    /// Spheres a < b, or a == b, that carry points together: where the second derivative has its blocks.
    const std::vector<std::array<int, 2>>& pairs() const { return pairs_; }
    /// d^2 energy / d step^2 in exponential coordinates: the block (a, b) of each pair [N/mm, N, N mm].
    std::vector<Block> curvature(const State& state, double share = 1) const;

    const State& rest() const { return rest_; }
    /// The force at rest, and how it changes with a step to first order: force - curvature * step (6N).
    Eigen::VectorXd linear_force(const Eigen::VectorXd& step) const;

private:
    struct Point {
        Attachment at;
        double weight;
        std::vector<int> pairs;  // of its shares i and j, the sphere of i not above that of j, in their order
    };
    struct Placed {
        std::shared_ptr<const fem::PointPotential> potential;
        std::vector<Point> points;
    };

    template <typename Visit>
    void for_each_point(const State& state, double share, const Visit& visit) const;

    State rest_;
    std::vector<Placed> effects_;
    PlacedSkin skin_;
    std::vector<int> skin_blocks_;  // the pair of each block that the skin visits
    double pressure_;               // [MPa]
    bool is_dead_;                  // is it?
    Cavities cavities_;
    std::vector<int> cavity_blocks_;  // the pair of each block that the cavities visit
    std::vector<std::array<int, 2>> pairs_;
    std::vector<char> supported_;
};

}  // namespace palpate::skeleton
