#pragma once

#include "fem/linear_algebra/multigrid/aggregates.h"
#include "mesh/types.h"

namespace palpate::fem {

/// Near-kernel (rigid-body modes) at the unknowns of a level (unknowns x 6).
using RigidModes = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/// The three translations, and the three rotations about the centre, of nodes (n x 3); lengths in units of the body's
/// size.
RigidModes rigid_modes(const Points& nodes);

/// From the unknowns of a coarse level, six to an aggregate, to those of the finer one.
template <int b>
struct Prolongator {
    BlockMatrix<b, 6> P;
    RigidModes modes;  // on the coarse level
};

/// Modes cut into aggregates, each made orthonormal by QR: P modes_coarse = modes. Where an aggregate is too small for
/// six modes to differ its last unknowns are nothing: their columns of P are zero. [Vanek et al. 1996, algorithm 4.1]
template <int b>
Prolongator<b> tentative_prolongator(const Aggregates& aggregates, const RigidModes& modes);

/// P <- (I - 4/3 / lambda D^-1 A) P, whose columns bend where they would have jumped. `inverse_diagonal`: the blocks of
/// D^-1; `lambda`: largest eigenvalue of D^-1 A.
template <int b>
void smooth(BlockMatrix<b, 6>& P, const BlockMatrix<b, b>& A, const BlockMatrix<b, b>& inverse_diagonal, double lambda);

extern template Prolongator<3> tentative_prolongator(const Aggregates&, const RigidModes&);
extern template Prolongator<6> tentative_prolongator(const Aggregates&, const RigidModes&);
extern template void smooth(BlockMatrix<3, 6>&, const BlockMatrix<3, 3>&, const BlockMatrix<3, 3>&, double);
extern template void smooth(BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&, double);

}  // namespace palpate::fem
