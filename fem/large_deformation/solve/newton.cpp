#include "fem/large_deformation/solve/newton.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mesh/system/interruption.h"

namespace palpate::fem {

namespace {

// A factor costs as much as 15 to 25 solutions, of which a step takes one, and one for each point that comes in touch
// or parts.
constexpr std::size_t most_solutions = 20;  // in a step: one that takes more asks for a factor
constexpr double slow = 0.7;                // of what the last step promised: one that promises more asks for a factor
constexpr std::size_t most_secants = 12;    // steps with one factor
constexpr int halvings = 30;                // of a step
constexpr double armijo = 1e-4;             // share of the decrease that the slope promises
constexpr double least_shift = 1e-5;        // share of the diagonal's mean
constexpr double most_shift = 100;          // of it: a step is the net force over the shift then, and another is wrong
// Of the terms that a potential adds up: a few hundred roundings, what independent ones of 10^5 terms come to.
constexpr double rounding_of_sums = 1e-13;
constexpr double shortest_next = 0.1,
                 longest_next = 0.5;     // of a step, the next that is tried: a parabola may be a poor guess
constexpr double watchdog_shift = 2e-2;  // where a watchdog_step landed: enough nearly always
constexpr int most_astray = 10;          // shifts on end: on the way to an equilibrium there are up to three
constexpr double roundings = 4;          // rounding is estimated as of independent errors; some go together
// Share of the largest displacement that a Newton step moves at most where nothing lowers the potential any more:
// readings are known to a thousandth of it at best, and the answer is good to far less than that.
constexpr double nothing_more = 1e-6;

}  // namespace

struct Newton::State {
    Eigen::VectorXd u;  // (3n)
    Eigen::VectorXd r;  // net force on the unknowns
    Potential potential;

    State(const LoadedBody& body, const Unknowns& unknowns, Eigen::VectorXd at) : u(std::move(at)) {
        Eigen::VectorXd net;
        potential = body.potential(u, net);
        if (std::isfinite(potential.value)) r = unknowns.gather(net);
    }
    /// Points that tools may touch.
    const std::vector<NearPoint>& near_points(const LoadedBody& body) const {
        if (!near_) near_ = body.near_points(u);
        return *near_;
    }

private:
    mutable std::optional<std::vector<NearPoint>> near_ = {};
};

Newton::Newton(const EliminationOrder& order, int iterations)
    : order_(order),
      allowed_(iterations),
      K_(order.unknowns.zero()),
      own_(make_tangent_solver(order, Accuracy::steps)) {}

/// Factors the tangent, if it is positive definite.
bool Newton::factor(const LoadedBody& body, const Eigen::VectorXd& u) {
    secants_.clear();
    std::fill_n(K_.valuePtr(), K_.nonZeros(), 0.0);
    body.add_tangent(u, order_.unknowns, K_);
    if (body.may_part()) active_.hold(body, order_.unknowns, body.near_points(u), K_);
    in_use_ = own_.get();
    ++factorisations_;
    return own_->take(K_);
}

/// Factors what `factor` could not, with `share` of the diagonal's mean size added to it.
bool Newton::factor_shifted(double share) {
    // The diagonal of a column is as far down as its component.
    const auto diagonal = [&](Eigen::Index k) -> double& { return K_.valuePtr()[K_.outerIndexPtr()[k] + k % 3]; };
    double sum = 0;
    for (Eigen::Index k = 0; k < K_.cols(); ++k) sum += std::abs(diagonal(k));
    const double shift = share * sum / static_cast<double>(K_.cols());
    for (Eigen::Index k = 0; k < K_.cols(); ++k) diagonal(k) += shift;
    ++factorisations_;
    return own_->take(K_);
}

/// Factors the tangent, shifted as little as makes it positive definite.
bool Newton::factor_with_shift(const LoadedBody& body, const Eigen::VectorXd& u) {
    const double last = std::exchange(shift_, 0);
    if (factor(body, u)) return true;
    for (shift_ = std::max(least_shift, last / 10); shift_ < most_shift; shift_ *= 10) {
        if (factor_shifted(shift_)) return true;
    }
    return false;
}

/// Steps from here: what the factor and the secants since make of net forces (unknowns x m). [Nocedal 1980]
Eigen::MatrixXd Newton::directions(const Eigen::MatrixXd& forces) const {
    MultiVector X = forces;
    Eigen::MatrixXd along(static_cast<Eigen::Index>(secants_.size()), forces.cols());
    for (std::size_t k = secants_.size(); k-- > 0;) {
        along.row(k) = secants_[k].s.transpose() * X / secants_[k].sy;
        X -= secants_[k].y * along.row(k);
    }
    in_use_->solve(X);
    for (std::size_t k = 0; k < secants_.size(); ++k)
        X += secants_[k].s * (along.row(k) - secants_[k].y.transpose() * X / secants_[k].sy);
    return X;
}

/// The step from a state.
Eigen::VectorXd Newton::step_from(const LoadedBody& body, const State& from) {
    if (!body.may_part()) return directions(from.r);
    return active_.step(body, order_.unknowns, from.r, from.near_points(body),
                        [&](const Eigen::MatrixXd& forces) { return directions(forces); });
}

/// Shortens the step until the potential falls; the share of it taken, 0: none. That of a body that flows is but near
/// the truth: far from balance it guides well, and close to it the net force does.
double Newton::search(const LoadedBody& body, const State& from, const Eigen::VectorXd& step, State& to) const {
    const Eigen::VectorXd whole = order_.unknowns.scatter(step);
    const double slope = from.r.dot(step);  // the decrease promised for length 1
    double length = 1;
    for (int k = 0; k < halvings; ++k) {
        to = State(body, order_.unknowns, from.u + length * whole);
        if (!std::isfinite(to.potential.value)) {
            length /= 4;
            continue;
        }
        const double end_slope = to.r.dot(step), change = to.potential.value - from.potential.value;
        if (change <= -armijo * length * slope) return length;
        if (body.conservative()) {
            // Where differences of energy drown in rounding the slope stands for them. [Hager & Zhang 2005]
            const double rounding = rounding_of_sums * to.potential.scale;
            if (change <= rounding && end_slope >= -(1 - 2 * armijo) * slope) return length;
        } else if (to.r.norm() <= (1 - armijo * length) * from.r.norm()) {
            return length;
        }
        // Where a parabola through both slopes has its least value.
        length *= std::clamp(slope / (slope - end_slope), shortest_next, longest_next);
    }
    return 0;
}

/// A large shear or bending step stretches the body, which the next step corrects: accepts the full `step` regardless
/// of the potential, and one more from there. Does that lead below `best`? [watchdog: Chamberlain et al. 1982]
bool Newton::watchdog_step(const LoadedBody& body, const State& from, const Eigen::VectorXd& step, State& best) {
    State over(body, order_.unknowns, from.u + order_.unknowns.scatter(step)), landed = over;
    if (!std::isfinite(over.potential.value) || !(factor(body, over.u) || factor_shifted(watchdog_shift))) return false;
    ++iterations_;
    const Eigen::VectorXd next_step = step_from(body, over);
    if (search(body, over, next_step, landed) == 0 || landed.potential.value >= best.potential.value) return false;
    predicted_decrease_ = next_step.dot(over.r);
    remember(body, over, landed);
    std::swap(best, landed);
    return true;
}

void Newton::remember(const LoadedBody& body, const State& from, const State& to) {
    const auto force = [&](const State& state) {
        return body.may_part() ? active_.held_force(body, order_.unknowns, state.r, state.near_points(body)) : state.r;
    };
    Secant secant{order_.unknowns.gather(to.u - from.u), force(from) - force(to), 0};
    secant.sy = secant.s.dot(secant.y);
    if (secant.sy > 0) secants_.push_back(std::move(secant));
}

bool Newton::minimise(const LoadedBody& body, const NewtonTolerance& tolerance, Eigen::VectorXd& u,
                      const TangentSolver* guide) {
    State here(body, order_.unknowns, u), next = here;
    bool factored = guide != nullptr;
    int astray = 0;
    in_use_ = guide;
    predicted_decrease_ = INFINITY;
    secants_.clear();
    if (body.may_part()) active_.start(here.near_points(body));
    for (int k = 0;; ++k) {
        Interruption::ask();
        u = here.u;
        residual_ = here.r.norm();
        const double enough = tolerance.absolute + tolerance.of_grip * here.potential.grip;
        if (residual_ <= enough || residual_ <= roundings * body.rounding(u)) return true;
        if (k == allowed_) return false;
        ++iterations_;

        // An old factor serves as long as steps with it bring enough.
        Eigen::VectorXd step;
        if (factored) {
            step = step_from(body, here);
            const double promises = step.dot(here.r);
            factored = promises > 0 && promises < slow * predicted_decrease_ && secants_.size() < most_secants &&
                       active_.solutions() <= most_solutions;
            predicted_decrease_ = promises;
        }
        const bool fresh = !factored;
        if (fresh) {
            if (!factor_with_shift(body, here.u)) return false;
            astray = shift_ > 0 ? astray + 1 : 0;
            if (astray > most_astray) return false;
            step = step_from(body, here);
            predicted_decrease_ = step.dot(here.r);
        }

        const double length = search(body, here, step, next);
        if (length == 0) {
            const bool stands = shift_ == 0 && step.cwiseAbs().maxCoeff() <= nothing_more * u.cwiseAbs().maxCoeff();
            if (fresh) return stands;
            factored = false;
            continue;
        }
        if (fresh && shift_ == 0 && length < 1 && body.conservative()) {
            factored = watchdog_step(body, here, step, next);
        } else {
            remember(body, here, next);
            factored = shift_ == 0;
        }
        std::swap(here, next);
    }
}

}  // namespace palpate::fem
