#pragma once

#include <vector>

#include "fem/large_deformation/body/loaded_body.h"
#include "fem/large_deformation/solve/active_set.h"
#include "fem/large_deformation/solve/tangent_solver.h"

namespace palpate::fem {

/// How much net force may stay [N].
struct NewtonTolerance {
    double absolute = 0;  // [N]
    double of_grip = 0;   // besides, as a share of the forces by which tools hold the body: these show as it is found
};

/// Finds where a loaded body's potential is least, over some unknowns; of one that flows, where its forces balance.
///
/// Newton's method with line search. A factor of the tangent serves for further steps, mended by BFGS updates with the
/// changes of force that they bring [Matthies & Strang 1979], as long as they bring enough. What tools touch may change
/// within a step. A tangent that is not positive definite is shifted until it is. Where there is no room for a factor
/// conjugate gradients solve for the steps, as well as these are worth [Newton-Krylov: Dembo, Eisenstat & Steihaug
/// 1982], or end where they meet negative curvature.
class Newton {
public:
    Newton(const EliminationOrder& order, int iterations);

    /// Moves u to where the norm of the net force on the unknowns is within `tolerance`, or what rounding makes of
    /// forces that balance; false when that takes more than the iterations allowed, goes no further, or leads from one
    /// unstable state to the next. `guide`: a factor over the same unknowns that the first steps are taken by, of the
    /// tangent in a state nearby. @pre no element is inside out at u.
    bool minimise(const LoadedBody& body, const NewtonTolerance& tolerance, Eigen::VectorXd& u,
                  const TangentSolver* guide = nullptr);

    int iterations() const { return iterations_; }          // in all
    int factorisations() const { return factorisations_; }  // in all
    double residual() const { return residual_; }           // the last one [N]

private:
    struct State;  // what holds at one displacement
    struct Secant {
        Eigen::VectorXd s, y;  // changes of displacement and of the potential's gradient, held points held
        double sy;
    };

    bool factor(const LoadedBody& body, const Eigen::VectorXd& u);
    bool factor_shifted(double share);
    bool factor_with_shift(const LoadedBody& body, const Eigen::VectorXd& u);
    Eigen::MatrixXd directions(const Eigen::MatrixXd& forces) const;
    Eigen::VectorXd step_from(const LoadedBody& body, const State& from);
    double search(const LoadedBody& body, const State& from, const Eigen::VectorXd& step, State& to) const;
    bool watchdog_step(const LoadedBody& body, const State& from, const Eigen::VectorXd& step, State& best);
    void remember(const LoadedBody& body, const State& from, const State& to);

    const EliminationOrder& order_;
    const int allowed_;
    LowerMatrix K_;
    std::unique_ptr<TangentSolver> own_;
    const TangentSolver* in_use_ = nullptr;  // what steps are taken by
    double shift_ = 0;                       // of the tangent's diagonal, as a share of its mean
    double predicted_decrease_ = 0;          // decrease of the potential, by its slope along the last step [N mm]
    std::vector<Secant> secants_;
    ActiveSet active_;
    int iterations_ = 0, factorisations_ = 0;
    double residual_ = 0;
};

}  // namespace palpate::fem
