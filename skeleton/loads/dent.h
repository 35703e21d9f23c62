#pragma once

#include "skeleton/loads/load.h"

namespace palpate::skeleton {

/// What spheres cannot follow round a contact: there the surface gives way by itself. A force f that presses on a patch
/// of radius r moves a point at distance D by
///   sum_R (a_R f_N + b_R f_T) k_R,  k_R = (1 - x)^2 (1 + 2 x) / sqrt(D^2 + (0.3 r)^2),  x = min(D / (R r), 1)
/// for R = 1, 2, 4, averaged over the patch, with f_N and f_T its parts along the surface's normal and across:
/// Boussinesq's 1 / D close to the patch, nothing beyond 4 r. The amplitudes (a_1, b_1, a_2, b_2, a_4, b_4) [1/MPa] are
/// the model's.
///
/// Motions of points at `rest` (m x 3) for amplitudes of 1 each: (3m x 6) [mm MPa].
Eigen::MatrixXd dent_motions(const Load& load, const Points& rest);

/// The motions themselves (m x 3) [mm], with the model's amplitudes.
Points dents(const Model& model, const Load& load, const Points& rest);

}  // namespace palpate::skeleton
