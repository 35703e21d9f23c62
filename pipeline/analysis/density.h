#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "identify/inference/posterior_row.h"
#include "pipeline/analysis/particles.h"

namespace palpate::pipeline {

/// A density over the logarithm of a positive quantity: (ln x, density), ascending.
using Density = std::vector<std::pair<double, double>>;

/// What was believed of a quantity before, and what is known of it now, over a common axis.
struct KnownBeforeAndAfter {
    std::string name, unit;  // of the axis; unit "": a ratio
    Density prior, posterior;
    double low = 0, middle = 0, high = 0;  // posterior: 2.5 %, median, 97.5 %
};

/// How stiffness is distributed before measuring.
enum class PriorKind { log_normal, even };  // even: in a box, by burion2008

/// One identified number. Posterior: of the weighted particles, smoothed with Gaussians in ln x [Silverman 1986, eq.
/// 3.31]. The axis holds the posterior and as much again on both sides, or all of a prior that is no wider than that.
/// @pre the row's prior mean and sd, and the particles, are above 0
KnownBeforeAndAfter density_of(const identify::PosteriorRow& row, const ParticleSet& particles, Eigen::Index column,
                               PriorKind prior);

/// Several numbers of a kind together, each over the middle of its prior: the mean of their densities.
KnownBeforeAndAfter pooled_density(const std::string& kind, const std::vector<identify::PosteriorRow>& rows,
                                   const ParticleSet& particles, const std::vector<Eigen::Index>& columns,
                                   PriorKind prior);

/// Both as SVG: prior dashed, posterior filled.
std::string density_chart(const KnownBeforeAndAfter& known);

}  // namespace palpate::pipeline
