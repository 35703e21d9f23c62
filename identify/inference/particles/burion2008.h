#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "identify/inference/particles/filter_step.h"
#include "mesh/progress.h"

namespace palpate::identify {

struct BurionOptions {
    int particles = 600;      // M
    int iterations = 20;      // K
    double search_low = 0.1;  // V: each multiplier lies in [low, high] at first
    double search_high = 10;
    double sigma_force = 0;   // sigma_F, of the first errors' unit; 0: see below
    double sigma_torque = 0;  // sigma_T, of the second errors'; 0: see below
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

/// Squared errors of particles, summed over the measurements: sum_j e(Y_j, X_m)^2.
struct ParticleErrors {
    Eigen::VectorXd forces;   // of equation 7, or distances in the position domain (M)
    Eigen::VectorXd torques;  // of equation 8 (M); empty in the position domain
};

/// Of particles of multipliers (M x P).
using MeasurementModel = std::function<ParticleErrors(const Eigen::MatrixXd& particles)>;

/// Algorithm 1 of [Burion, Conti, Petrovskaya, Baur, Khatib: Identifying physical properties of deformable objects by
/// using particle filters, ICRA 2008] for P multipliers, over either of its two measurement models: the net forces and
/// torques that the measurements leave on the nodes (section III.B), or the distances between measured and modelled
/// markers, which takes an equilibrium a particle and measurement (section III.A, "most instinctive").
///
/// As printed, but for three points:
/// - Equations 7 and 8 add up signed vectors over the nodes. That sum sees the reactions only, as a link's two forces
///   cancel in it: it is blind to the stiffness. The norm over all nodes is meant and to be given.
/// - Weights are logarithms. The product of equation 9 underflows else.
/// - The paper tells no values for sigma_F, sigma_T, sigma_r. Where none are given, the two sigmas are set anew in each
///   iteration, in the ratio of the mean square errors of the first particles, so that a fifth of the particles stays
///   effective; sigma_r is a third of the present spread of each parameter. So the cloud closes in on the solution
///   instead of stopping at its mutation noise.
///
/// sigma stands unsquared in equation 6: it is a variance.
BurionResult burion2008(const MeasurementModel& errors_of, int P, const BurionOptions& options,
                        const Progress& progress = {});

}  // namespace palpate::identify
