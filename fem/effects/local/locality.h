#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A part of a body without a border: a Gaussian weight g(X) = exp(-|X - centre|^2 / (2 radius^2)).
struct Locality {
    Vec3 centre = Vec3::Zero();  // [mm]
    double radius = 1;           // 1 sd of the weight [mm], > 0

    /// Shares of points in that part (n), which add up to 1: their even weights times g. Where none of them is near,
    /// the nearest one has it all.
    Eigen::VectorXd shares(const Points& rest, const Eigen::VectorXd& even) const;
};

/// How files and users tell it: cx, cy, cz and radius.
std::vector<KnownParameter> locality_parameters();
Locality locality(const EffectNumbers& numbers);

}  // namespace palpate::fem
