#pragma once

#include <string>
#include <vector>

#include "identify/preflight/prospects/linear_point.h"

namespace palpate::identify {

/// How well a set would determine a number, and what is believed of it before.
struct ParameterProspect {
    std::string name;
    double value = 0, sd = 0, prior_sd = 0;  // of the fit's number; sd: after the measurements
    /// As posterior.csv counts it.
    bool informed() const { return sd <= 0.7 * prior_sd; }
};

/// A part of the body and how well its own stiffness, relative to the rest, would be known.
struct PartProspect {
    Vec3 at;                      // its middle [mm]
    ParameterProspect stiffness;  // ln of it; one prior standard deviation is a factor of two
};

struct ParameterProspects {
    std::vector<ParameterProspect> material;  // the stiffness numbers of the model
    std::vector<PartProspect> parts;
    std::vector<int> part_of_piece;  // of the model's pieces
};

/// Posterior of the stiffness numbers, to first order; and of the body's parts, each with a stiffness of its own.
ParameterProspects parameter_prospects(const BodyModel& model, const Problem& problem, const LinearPoint& point,
                                       int threads);

}  // namespace palpate::identify
