#pragma once

#include "identify/inference/particles/hamiltonian/density_with_gradient.h"
#include "identify/inference/particles/tempered_filter.h"

namespace palpate::identify {

struct HamiltonianOptions {
    int particles = 200;      // at least, >= 10
    int chains = 6;           // of each of two clouds
    double effective = 100;   // independent draws that all of them are worth, where `evaluations` come to it
    int evaluations = 40000;  // of the density, half of them for each cloud, that chains are continued within
    std::uint64_t seed = 1;
    int threads = 1;
};

/// Particles of a posterior pi in hundreds of directions, by its gradients: two independent clouds of Markov chains.
/// Each chain starts from a draw of a Gaussian q near the posterior, is annealed through q^(1-b) pi^b from b = 0 to 1,
/// then moves by Hamiltonian Monte Carlo, which leaves pi invariant [HamiltonianMoves]. Every state of a chain from
/// then on is a particle, and all weigh the same.
///
/// The next temperature lets ln(pi / q) change by about one, or is twice the last. The angle of a step follows the
/// acceptance until the chains have settled at b = 1, and is fixed from then on. As long as the particles are worth
/// fewer than `effective` independent ones, or R-hat is above 1.1, the chains are continued, twice as far each time,
/// and what they began with is left out. The integral of ln(pi / q) over b is the logarithm of the evidence; R-hat
/// compares the two clouds. The numbers depend on the seed, not on the threads.
/// @throws SolverFailure when no draw has a density, no trajectory is accepted however short its steps, or those are so
/// short that `evaluations` do not come to the particles.
TemperedResult hamiltonian_filter(const DensityWithGradient& density, const GaussianProposal& q,
                                  const HamiltonianOptions& options, const Progress& progress = {});

}  // namespace palpate::identify
