#include "skeleton/statics/newton.h"

#include <algorithm>
#include <cmath>

#include "skeleton/blocks/tangent_shift.h"

namespace palpate::skeleton {

namespace {

constexpr double sufficient_decrease = 1e-4;  // of what the slope at the start promises
constexpr double most_left = 0.25;       // of the net force, by a step with a tangent from nearby that is worth another
constexpr double deep = 1e-3;            // of the tolerance
constexpr int most_halvings = 27;        // a share of 1e-8: where none leads down, the direction is wrong
constexpr double within_rounding = 1e3;  // times a potential's rounding, up to which a rise of it tells nothing
constexpr int inverse_iterations = 10;   // to a direction that need not be exact: any that leads down serves
constexpr double first_share = 0.2;      // of the longest step allowed, along that direction
constexpr int saddle_halvings = 18;      // a share of 1e-6: nearer to the saddle its fall drowns in rounding

// What is sought, all together.
struct Problem {
    SkeletonSystem& system;
    const Eigen::VectorXd& k;
    const Load& load;

    Balance balance(const State& state) const { return system.balance(k, state, load); }
};

// Factors the tangent with the least shift tried, from `shift` upwards, that makes it positive definite; 0 is tried
// as such. False when none does.
bool factor_shifted(const Problem& problem, double& shift) {
    const double stiffest = problem.system.stiffest(problem.k);
    while (problem.system.factor(shift)) {
        shift = larger_shift(shift, stiffest);
        if (!can_shift(shift, stiffest)) return false;
    }
    return true;
}

// Moves along `step` so far that the potential falls as it should [Armijo]. Where that drowns in rounding, as terms of
// a link cancel, the slopes at both ends tell its fall. [Hager & Zhang 2005]
bool descend(const Problem& problem, const Eigen::VectorXd& step, State& state, Balance& here) {
    const double slope = here.net.dot(step);
    double share = problem.system.step_limit(state, step);
    for (int halving = 0; halving < most_halvings; ++halving, share /= 2) {
        const State trial = problem.system.advance(state, step, share);
        const Balance there = problem.balance(trial);
        const double fall = here.potential - there.potential, left = there.net.dot(step);
        const bool falls = fall >= sufficient_decrease * share * slope - here.rounding;
        const bool falls_by_slopes = fall >= -within_rounding * here.rounding &&
                                     left >= (2 * sufficient_decrease - 1) * slope && there.largest < here.largest;
        if (falls || falls_by_slopes) {
            state = trial;
            here = there;
            return true;
        }
    }
    return false;
}

// From an equilibrium that is not stable a little way along its softest direction, found by inverse iteration with the
// shifted tangent, to where the potential is lower.
bool leave_saddle(const Problem& problem, State& state, Balance& here) {
    Eigen::VectorXd direction(here.net.size());
    for (Eigen::Index i = 0; i < direction.size(); ++i) direction[i] = std::sin(1.0 + static_cast<double>(i));
    for (int iteration = 0; iteration < inverse_iterations; ++iteration)
        direction = problem.system.solve(problem.system.metric_times(direction)).normalized();
    direction *= 1e3 * problem.system.length();  // beyond the limit, which cuts it
    direction *= problem.system.step_limit(state, direction);
    double share = first_share;
    for (int halving = 0; halving < saddle_halvings; ++halving, share /= 2)
        for (const double sign : {1.0, -1.0}) {
            const State trial = problem.system.advance(state, direction, sign * share);
            const Balance there = problem.balance(trial);
            if (there.potential < here.potential - here.rounding) {
                state = trial;
                here = there;
                return true;
            }
        }
    return false;
}

// Steps by a tangent from nearby as long as each leaves little: one takes far less than a factor does. They end deeper
// than need be, as those of the tangent itself do, for the last factor is to be that of the equilibrium.
void settle(const Problem& problem, const NearbyTangent& solve, double tolerance, State& state, Balance& here) {
    if (here.largest <= tolerance) return;
    while (here.largest > deep * tolerance) {
        const Eigen::VectorXd step = solve(here.net);
        if (problem.system.step_limit(state, step) < 1) return;
        const State trial = problem.system.advance(state, step, 1);
        const Balance there = problem.balance(trial);
        const bool falls = there.potential <= here.potential + here.rounding;  // or it leads back to a saddle
        if (!falls || !(there.largest < most_left * here.largest)) return;
        state = trial;
        here = there;
    }
}

}  // namespace

bool newton(SkeletonSystem& system, const Eigen::VectorXd& k, const Load& load, const EquilibriumOptions& options,
            Equilibrium& at) {
    const Problem problem{system, k, load};
    const double tolerance =
        std::max(options.tolerance * system.largest_load(k, at.state, load), system.force_rounding(k));
    double shift = 0;
    Balance here = problem.balance(at.state);
    if (options.nearby) settle(problem, options.nearby, tolerance, at.state, here);
    for (int iteration = 0;; ++iteration, ++at.iterations) {
        at.residual = here.largest;
        system.assemble(k, at.state, &load);

        // An equilibrium counts where the tangent needs no shift.
        const bool balanced = here.largest <= tolerance;
        if (balanced) {
            const auto pivot = system.factor(0);
            if (!pivot) return true;
            if (pivot->zero) system.fail_at(*pivot, k);
        }
        if (iteration == options.iterations || !factor_shifted(problem, shift)) return false;

        const bool moved =
            balanced ? leave_saddle(problem, at.state, here) : descend(problem, system.solve(here.net), at.state, here);
        if (!moved) return false;
        shift = smaller_shift(shift, system.stiffest(k));
    }
}

}  // namespace palpate::skeleton
