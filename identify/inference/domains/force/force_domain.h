#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "identify/inference/problem/parameters.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

/// A measured configuration of all spheres, and what acted in it.
struct MeasuredConfiguration {
    skeleton::State state;
    skeleton::Load load;
};

/// Squared net force as a quadratic of the multipliers m = exp(theta) (P), summed over measurements:
///   sum_j |A_j m + f_j|^2 = m^T H m + 2 g^T m + c.
/// All that particles need to know of the measurements, however many those are.
struct ForceStatistics {
    Eigen::SparseMatrix<double> H;  // (P x P) [N^2]; links that share no sphere have none in common
    Eigen::VectorXd g;              // (P) [N^2]
    double c = 0;                   // [N^2]
    int rows = 0;                   // net forces that were summed
};

/// Of each particle of multipliers (N x P), all at once (N) [N^2]; see quadratic_forms.
Eigen::VectorXd squared_errors(const ForceStatistics& statistics, const Eigen::MatrixXd& particles);

/// Net forces and net torques on the free spheres in measured configurations, the model's effects in force; exact
/// sufficient statistics, since both are linear in the stiffnesses. Torques are over the mean link length. [Burion
/// 2008, eqs. 7-8]
struct ForceDomain {
    ForceStatistics forces, torques;
};

ForceDomain force_domain(const skeleton::Model& model, const Parameters& parameters,
                         const std::vector<MeasuredConfiguration>& measured);

/// The multipliers >= 0 with the smallest net force: argmin m^T H m + 2 g^T m, the mode of a truncated Gaussian. A
/// sparse Cholesky factorisation for each set of multipliers at zero; that set is found by exchanging all that are on
/// the wrong side at once [Portugal, Judice, Vicente 1994; Kim, Park 2011].
/// Directions that the measurements leave open stay at 1, by a prior of `prior_share` of H's mean diagonal.
/// @throws SolverFailure where H is singular and the prior lifts it by nothing.
Eigen::VectorXd solve_force_domain(const ForceStatistics& statistics, double prior_share = 1e-11);

ForceStatistics operator+(const ForceStatistics& a, const ForceStatistics& b);

}  // namespace palpate::identify
