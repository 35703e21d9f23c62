#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "fem/effects/effects.h"
#include "fem/rig/tool_potential.h"
#include "skeleton/effects/placed_skin.h"
#include "skeleton/effects/placed_tendon.h"
#include "skeleton/effects/point_sets.h"
#include "skeleton/loads/cavities.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// Effects in force on a skeleton that are not in its links: potentials on points that its spheres carry, tools among
/// them, energies of its skin's area, the pull of tendons, and pressure in the cavities of its skin,
///   Pi = sum_i w_i e(X_i, p_i) + sum_t A_t w(X_t, J_t) + tendons - sum_c pressure_c V_c,  p = sum_s share_s (x_s + R_s
///   r_s),
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

    bool empty() const { return effects_.empty() && skin_.empty() && tendons_.empty() && cavities_.empty(); }
    bool release_supports() const;
    /// Spheres that support points hang on (flags, N).
    const std::vector<char>& supported() const { return supported_; }

    /// `share`, here and below, scales the effects that hold no support: a load that is put on step by step, of which a
    /// tool has made that share of its motion.
    Energy energy(const State& state, double share = 1) const;
    /// - d energy / d step (6N) [N, N mm].
    Eigen::VectorXd force(const State& state, double share = 1) const;

    /// Spheres a < b, or a == b, that carry points together: where the second derivative has its blocks.
    const std::vector<std::array<int, 2>>& pairs() const { return pairs_; }
    /// d^2 energy / d step^2 in exponential coordinates: the block (a, b) of each pair [N/mm, N, N mm].
    std::vector<Block> curvature(const State& state, double share = 1) const;

    /// How large the load is at rest (6N): as `force`, but for tools and cables, which hold with forces far beyond
    /// those that they will have. These make up for it by E L times their way, L a length of the body.
    Eigen::VectorXd load_at_rest() const;
    double load_of_tools(double length) const;
    /// Calls visit(point in that state, the potential's terms times its weight) for the points that feel a tool, by the
    /// place of the tool among the effects'.
    template <typename Visit>
    void for_each_point_of_tool(std::size_t tool, const State& state, const Visit& visit) const;

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
        // Of a tool, else null; and the largest gradient at which the points' turning counts: far from balance it would
        // only lead astray, and to first order it is none.
        std::shared_ptr<const fem::ToolPotential> tool = nullptr;
        double turns_within = INFINITY;
    };
    struct PlacedPressure {
        double pressure;  // [MPa]
        Cavities cavities;
        std::vector<int> blocks;  // the pair of each block that they visit
    };

    template <typename Visit>
    void for_each_point(const State& state, double share, const Visit& visit) const;
    template <typename Pair>
    void place(Placed effect, const PointSet& set, const Eigen::VectorXd& weights, const Pair& pair);
    template <typename Pair>
    void place(double pressure, Cavities cavities, const Pair& pair);
    static void add_force(const CarriedPoint& at, const Vec3& force, Eigen::VectorXd& f);
    void add_force_of_bodies(const State& state, double share, Eigen::VectorXd& f, bool cables = true) const;

    State rest_;
    std::vector<Placed> effects_;
    PlacedSkin skin_;
    std::vector<int> skin_blocks_;  // the pair of each block that the skin visits
    bool is_linear_;                // the law
    std::vector<PlacedPressure> cavities_;
    std::vector<PlacedTendon> tendons_;
    std::vector<std::vector<int>> tendon_blocks_;  // the pair of each block that each tendon visits
    std::vector<std::array<int, 2>> pairs_;
    std::vector<char> supported_;
};

template <typename Visit>
void PlacedEffects::for_each_point_of_tool(std::size_t tool, const State& state, const Visit& visit) const {
    std::size_t place = 0;
    for (const Placed& effect : effects_) {
        if (!effect.tool || place++ != tool) continue;
        for (const Point& point : effect.points) {
            fem::PointTerms terms = effect.potential->terms(point.at.rest, carried_place(point.at, rest_, state));
            if (terms.hessian.isZero(0)) continue;  // not in touch
            terms.energy *= point.weight;
            terms.gradient *= point.weight;
            terms.hessian *= point.weight;
            visit(CarriedPoint(point.at, rest_, state), terms);
        }
    }
}

}  // namespace palpate::skeleton
