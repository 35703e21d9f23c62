#pragma once

#include <cstdint>
#include <vector>

#include "identify/fit/force_domain.h"
#include "identify/identify.h"
#include "mesh/progress.h"

namespace palpate::identify {

struct BurionOptions {
    int particles = 600;      // M
    int iterations = 20;      // K
    double search_low = 0.1;  // V: each multiplier lies in [low, high] at first
    double search_high = 10;
    double sigma_force = 0;   // sigma_F [N^2]; 0: see below
    double sigma_torque = 0;  // sigma_T [N^2], torques over the mean link length; 0: see below
    double mutation = 0;      // sigma_r, as a share of V's sides; 0: see below
    std::uint64_t seed = 1;
};

struct BurionResult {
    Eigen::MatrixXd particles;        // multipliers (M x P)
    Eigen::VectorXd log_weights;      // (M), normalised
    Eigen::VectorXd best;             // the particle of highest weight of all iterations (P)
    Eigen::VectorXd mean, sd;         // of the particles (P)
    std::vector<FilterStep> history;  // (K), particles as multipliers
};

/// Algorithm 1 of [Burion, Conti, Petrovskaya, Baur, Khatib: Identifying physical properties of deformable objects by
/// using particle filters, ICRA 2008], over the net forces and torques that the measurements leave on the nodes.
///
/// As printed, but for three points:
/// - Equations 7 and 8 add up signed vectors over the nodes. That sum sees the reactions only, as a link's two forces
///   cancel in it: it is blind to the stiffness. The norm over all nodes is meant and taken.
/// - Weights are logarithms. The product of equation 9 underflows else.
/// - The paper tells no values for sigma_F, sigma_T, sigma_r. Where none are given, the two sigmas are set anew in each
///   iteration, in the ratio of the mean square errors of the first particles, so that a fifth of the particles stays
///   effective; sigma_r is a third of the present spread of each parameter. So the cloud closes in on the solution
///   instead of stopping at its mutation noise.
///
/// sigma stands unsquared in equation 6: it is a variance.
BurionResult burion2008(const ForceStatistics& forces, const ForceStatistics& torques, const BurionOptions& options,
                        const Progress& progress = {});

}  // namespace palpate::identify
