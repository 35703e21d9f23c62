#pragma once

#include <memory>
#include <vector>

#include "identify/inference/domains/position/links/strains.h"
#include "identify/inference/domains/position/rest_law.h"
#include "identify/inference/domains/position/slopes.h"
#include "identify/inference/domains/position/solver_pool.h"
#include "identify/inference/problem/parameters.h"
#include "identify/loading/readings.h"

namespace palpate::identify {

/// A model's answer to all loads: where it stands, and the markers.
struct Prediction {
    std::vector<skeleton::Equilibrium> equilibria;  // (states)
    std::vector<Points> markers;                    // of each state (m x 3) [mm]
    std::vector<TangentSolve> tangents;             // of each state, or one for all; none: they were not kept
    // What a body that yields went through before each state, since the last one that was read (states).
    std::vector<std::vector<skeleton::Equilibrium>> unmeasured;
};

/// Errors of the markers at the model's own equilibria, and their derivatives by theta, the log multipliers.
///
/// A reading's sigma. A coarse model errs by more than the noise, and alike for neighbouring markers: a thousand
/// vertices must not count as a thousand independent readings. So a state's readings together count as about six
/// of the relative model error `rel`:
///   sigma^2 = noise^2 + max(1, n / 6) rel^2 (u^2 + (u_0 / 3)^2)
/// with n the state's measured coordinates, u their rms displacement and u_0 the median of u over the states: so that a
/// nearly motionless state, for instance one probed next to a clamp, does not dominate through its small u.
class PositionDomain {
public:
    /// States uninformative about stiffness are left out. @pre at least one is informative.
    PositionDomain(const skeleton::Model& model, skeleton::EquilibriumLaw law, Parameters parameters,
                   const std::vector<StateReadings>& readings, int threads);

    const Parameters& parameters() const { return parameters_; }
    const std::vector<StateReadings>& states() const { return states_; }
    int coordinates() const;            // measured, in all
    int effective_coordinates() const;  // the same, at most six a state
    skeleton::EquilibriumLaw law() const { return model_->law; }
    int spheres() const { return static_cast<int>(model_->spheres.size()); }

    /// What a state's model error is told in shares of, u^2 + (u_0 / 3)^2 [mm^2].
    double squared_scale(int s) const;
    double least_displacement() const { return typical_displacement_ / 3; }  // u_0 / 3 [mm]
    double squared_noise(int s) const;                                       // mean over a state's readings [mm^2]

    /// Sets all sigmas.
    void set_model_error(double rel);
    /// The `rel` that explains what a prediction leaves beyond the noise: the median over the states. 0 where the noise
    /// is enough: the six readings that a state counts as would be six of very noisy ones else.
    double estimate_model_error(const Prediction& prediction) const;

    /// Equilibria at k(theta). `start`: those of a neighbouring theta. `for_jacobian`: with the tangents that they
    /// leave factored. Safe from several threads, with `threads` 1. @throws SolverFailure where there is none.
    Prediction predict(const Eigen::VectorXd& theta, int threads, const Prediction* start = nullptr,
                       bool for_jacobian = false) const;
    /// A prediction brought nearer to a theta that is one step away, to first order, for `predict` to start from.
    Prediction advanced(const Prediction& prediction, const ErrorJacobian& jacobian, const Eigen::VectorXd& step) const;
    double chi_squared(const Prediction& prediction) const;
    /// Measured less modelled, of a state, zero for a missing coordinate (3m).
    Eigen::VectorXd errors(int s, const Points& markers) const;
    double squared_distance(const Prediction& prediction) const;  // between measured and modelled [mm^2]
    /// ln of the likelihood's constant: - sum ln(sigma sqrt(2 pi)).
    double log_constant() const { return log_constant_; }
    /// Of the errors, at theta with its equilibria.
    ErrorJacobian jacobian(const Eigen::VectorXd& theta, const Prediction& prediction) const {
        return jacobian(theta, prediction, threads_);
    }
    ErrorJacobian jacobian(const Eigen::VectorXd& theta, const Prediction& prediction, int threads) const;

    /// Half of chi^2 and its gradient by theta (P), for about the price of two predictions. `start`: as for predict.
    /// Safe from several threads. @throws SolverFailure where there is no equilibrium.
    double half_chi_squared(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient,
                            const Prediction* start = nullptr) const;
    /// Does that take but two solutions of linear equations? By the linear law, where volumes are at rest.
    bool has_adjoint_gradient() const { return law() == skeleton::EquilibriumLaw::linear && strains_ != nullptr; }

    /// The dents' amplitudes that explain most of what a prediction leaves, in force from then on: linear least
    /// squares, and a prior sd of what a half space of the links' modulus gives way by, 1 / E. `prediction`, at theta,
    /// is brought up to date. False if there is no contact, or the links have no sections from which a modulus follows.
    bool fit_dents(const Eigen::VectorXd& theta, Prediction& prediction);
    const Eigen::Matrix<double, 6, 1>& dent() const { return dent_; }

    /// Logarithm of the factor on all stiffnesses k(theta) that fits best by the linear law, where displacements go as
    /// its inverse: closed form, however far off the start is. 0 where they do not, as effects add a stiffness of
    /// their own.
    double common_factor(const Eigen::VectorXd& theta) const;

    /// The same domain by the linear law, its markers moved by what `prediction`, at theta, differs from that law's
    /// there: a cheap stand-in for large rotations near theta.
    PositionDomain linearised(const Eigen::VectorXd& theta, const Prediction& prediction) const;

    /// The same law, with what it has factored so far, for other readings of the body; u_0 stays.
    PositionDomain over(const std::vector<StateReadings>& readings, double model_error) const;

private:
    void take_states(const std::vector<StateReadings>& readings);
    void take_law();
    Prediction predict_linear(const Eigen::VectorXd& k) const;
    double half_chi_squared_linear(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) const;
    TangentSolve linear_tangent(const Eigen::VectorXd& k) const;
    struct Borrowed;
    std::shared_ptr<Borrowed> borrow() const;
    static TangentSolve tangent_of(std::shared_ptr<Borrowed> borrowed);  // with what its solver has factored
    TangentSolve factored(const skeleton::Load& load, const Eigen::VectorXd& k, const skeleton::Equilibrium& at) const;
    Points dented(int s, const Eigen::Matrix<double, 6, 1>& dent) const;  // (m x 3) [mm]

    std::shared_ptr<const skeleton::Model> model_;
    std::shared_ptr<SolverPool> solvers_;
    std::shared_ptr<const LinearStatics> linear_statics_;  // linear law alone
    std::shared_ptr<const LinksAtRest> links_;
    std::shared_ptr<const Strains> strains_;  // linear law alone, where its volumes are at rest
    Parameters parameters_;
    std::vector<StateReadings> states_;
    std::vector<Points> offsets_;         // added to the modelled markers (m x 3) [mm]
    std::vector<Eigen::MatrixXd> dents_;  // dent_motions of each state's markers (3m x 6), empty without
    Eigen::Matrix<double, 6, 1> dent_;    // amplitudes [1/MPa]
    std::vector<std::shared_ptr<const Eigen::SparseMatrix<double>>> P_;  // of each state at rest (3m x 6N)
    Eigen::MatrixXd F_;                                                  // loads and effects at rest (6N x states)
    Eigen::SparseMatrix<double> G_rest_;    // those of the links, of each stiffness (6N x 3L)
    std::vector<Eigen::VectorXd> weights_;  // 1 / sigma^2, 0 for a missing coordinate, of each state (3m)
    bool goes_as_inverse_ = true;           // displacement, with a factor on all stiffnesses
    double typical_displacement_ = 0;       // u_0 [mm]
    double log_constant_ = 0;
    int threads_ = 1;
};

}  // namespace palpate::identify
