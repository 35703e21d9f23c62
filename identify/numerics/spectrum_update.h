#pragma once

#include "identify/numerics/spectrum.h"

namespace palpate::identify {

/// Leading eigenpairs, `most` at the most and none below `least`, of V diag(values) V^T + B B^T, B (P x k): exact but
/// for what is left out. For the price of the vectors, not of the matrix. [Brand 2006]
Spectrum added(const Spectrum& spectrum, const Eigen::MatrixXd& B, Eigen::Index most, double least);

}  // namespace palpate::identify
