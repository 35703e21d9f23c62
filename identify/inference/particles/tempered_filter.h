#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "identify/inference/particles/filter_step.h"
#include "identify/inference/particles/proposal.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"

namespace palpate::identify {

/// Logarithm of the unnormalised posterior density, likelihood times prior; -inf where there is none. Called from
/// several threads at once.
using LogDensity = std::function<double(const Eigen::VectorXd& theta)>;

struct TemperedOptions {
    int particles = 200;           // N, >= 10
    int moves = 10;                // per temperature at most, >= 1
    double least_effective = 0.5;  // of N, sets the temperatures, (0, 1)
    int temperatures = 500;        // at most
    bool at_once = false;          // draws that can be weighed at once, or nothing
    std::uint64_t seed = 1;
    int threads = 1;
};

struct TemperedResult {
    Eigen::MatrixXd particles;         // (N x P); more than N where more draws made moves needless
    Eigen::VectorXd log_weights;       // (N), normalised
    Eigen::VectorXd log_density;       // of each particle (N)
    std::vector<int> mode;             // of each particle: the Gaussian of q that is densest there (N)
    double log_evidence = 0;           // ln of the integral of the density
    double log_evidence_sd = missing;  // by how much that may be off; NaN: not estimated
    double r_hat = missing;            // of two independent clouds, 1: they agree; NaN: there is but one
    bool weighed = true;               // false: too many parameters for that, see below
    int independent = 0;               // draws that the particles mix; 0: each is its own
    double acceptance = 0;             // of all moves
    int evaluations = 0;               // of the density
    std::vector<FilterStep> history;   // a step per temperature, the proposal's particles first
};

/// Particles of a posterior pi, tempered from a proposal q, a mixture of equal parts of Gaussians q_k, one a mode that
/// is known: their density goes through q^(1-b) pi^b from b = 0 to 1. [Neal 2001; Del Moral, Doucet, Jasra 2006]
///
/// Each temperature: b grows until the effective sample size falls to `least_effective` N (by bisection); low-variance
/// resampling; moves by preconditioned Crank-Nicolson in the whitened coordinates z of the q_k that a particle came
/// from,
///   z' = sqrt(1 - s^2) z + s xi,  xi ~ N(0, 1),
/// which are reversible under q_k, so that a move is accepted by the tempered correction (pi / q)^b alone and does not
/// die with the dimension [Cotter, Roberts, Stuart, White 2013]; s keeps 20-40 % of the moves accepted. (A particle and
/// its k have the density q_k (pi / q)^b, whose sum over k is q^(1-b) pi^b: so modes keep their weights, near or far
/// from each other, though no particle goes from one to the other.) Moves go on
/// until resampled copies have decorrelated: until their squared path lengths add up to half the squared distance of
/// two particles; the last ones, which stay weighted, further. Where q is so near that its draws, weighed by pi / q at
/// once, are worth the wanted number of equal ones, within four times N of them, that is all: such draws are
/// independent, and no copies.
///
/// Where `moves` of them do not part the copies and there are fewer than four particles a parameter (a posterior unlike
/// q in many of its parameters), resampling would leave a handful of particles in many copies, and intervals far too
/// narrow. Then nothing is weighed: all particles of q are moved by the posterior's own rule, twice `moves`, and stay
/// equal; the evidence is then Laplace's, pi / q at the mean.
///
/// With `at_once` it ends where the draws cannot be weighed at once, `weighed` false.
///
/// The numbers depend on the seed, not on the threads.
/// @throws SolverFailure when no particle has a density, or `temperatures` do not reach the posterior.
TemperedResult tempered_filter(const LogDensity& log_density, const std::vector<GaussianProposal>& proposals,
                               const TemperedOptions& options, const Progress& progress = {});

}  // namespace palpate::identify
