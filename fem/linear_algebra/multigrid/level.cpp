#include "fem/linear_algebra/multigrid/level.h"

namespace palpate::fem {

template <int b>
Coarsened<b> coarsen(const BlockMatrix<b, b>& A, const RigidModes& modes, double strength) {
    BlockMatrix<b, b> D = inverse_diagonal(A);
    const double lambda = largest_eigenvalue(A, D);
    auto [P, coarse_modes] = tentative_prolongator<b>(aggregate(A, strength), modes);
    smooth(P, A, D, lambda);
    BlockMatrix<6, b> restriction = transpose(P);
    BlockMatrix<6, 6> coarse = product(restriction, product(A, P));
    return {{rounded(A), Chebyshev<b>(std::move(D), lambda), rounded(P), rounded(restriction)},
            std::move(coarse),
            std::move(coarse_modes)};
}

template Coarsened<3> coarsen(const BlockMatrix<3, 3>&, const RigidModes&, double);
template Coarsened<6> coarsen(const BlockMatrix<6, 6>&, const RigidModes&, double);

}  // namespace palpate::fem
