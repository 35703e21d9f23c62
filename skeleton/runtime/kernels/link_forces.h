#pragma once

#include <span>

#include "skeleton/runtime/kernels/tables.h"

namespace palpate::runtime {

/// Damping of links: each strain s of a link resists its rate as well, with k (s + beta ds/dt). Rigid motions cost
/// nothing, so momenta are kept.
struct Rates {
    const double* velocity = nullptr;  // rows of the spheres; null: none are known, and none count
    double beta = 0;                   // [s]
};

/// Adds the forces of the paper's links to the spheres' rows; returns their energy [N mm]. The laws are those of
/// link_terms in skeleton/links/link_energy.h.
double add_paper_links(std::span<const PaperLinks> links, const double* pose, const Rates& rates, double* force);

/// Adds the forces of full links; returns their energy, without that of volumes. The laws are those of FullLink in
/// skeleton/links/full_link.h. `couplings`: of as many links, or none. `pressure` [MPa], one a sphere, presses the
/// links' sections apart; null: none.
double add_full_links(std::span<const FullLinks> links, std::span<const SectionCouplings> couplings, const double* pose,
                      const Rates& rates, const double* pressure, double* force);

/// Adds what the spheres' cells swell by, 1/2 A s of each link, to `swelling` [mm^3], one a sphere; with rates 1/2 A (s
/// + beta ds/dt), which is what resists.
void add_swelling(std::span<const FullLinks> links, const double* pose, const Rates& rates, double* swelling);

}  // namespace palpate::runtime
