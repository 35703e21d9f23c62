#pragma once

#include "mesh/types.h"

namespace palpate::fem {

/// A part of a body without a border: a Gaussian weight g(X) = exp(-|X - centre|^2 / (2 radius^2)).
struct Locality {
    Vec3 centre = Vec3::Zero();  // [mm]
    double radius = 1;           // 1 sd of the weight [mm], > 0

    /// g(X) [-].
    double weight(const Vec3& X) const;
    /// Shares of points in that part (n), which add up to 1: their even weights times g. Where none of them is near,
    /// the nearest one has it all.
    Eigen::VectorXd shares(const Points& rest, const Eigen::VectorXd& even) const;
};

}  // namespace palpate::fem
