#pragma once

#include <vector>

#include "fem/effects/effects.h"
#include "skeleton/links/fibres/link_fibre.h"

namespace palpate::skeleton {

/// What a fibre has been through.
struct FibreState {
    double strain = 0;       // plastic, as it is now [-]
    double accumulated = 0;  // sum of its changes' magnitudes [-]
    double most = 0;         // greatest energy of elastic strain that it has borne, over the shear modulus [-]
};

/// Of all fibres of all links (12L), link by link; empty: all are new.
using FibreStates = std::vector<FibreState>;

/// What a fibre has flowed to once its strain was lambda - 1: the return mapping of one dimension.
/// [Simo & Hughes 1998, box 1.4]
FibreState flow(const fem::Plasticity& plasticity, const FibreState& before, double lambda);

/// Its derivatives by lambda and by the strain and the sum before: of the strain in the first row, of the sum below.
Eigen::Matrix<double, 2, 3> flow_derivatives(const fem::Plasticity& plasticity, const FibreState& before,
                                             double lambda);

/// What yielding adds to the elastic energy 1/2 e^2 of a fibre, e = lambda - 1 the strain by which links measure
/// theirs, as a share of Young's modulus [-]:
///   p(e) = min over e_p of  1/2 (e - e_p)^2 + y |e_p - e_p0| + h/2 (a^2 - a_0^2)  -  1/2 e^2,   a = a_0 + |e_p -
///   e_p0|,
/// y the yield strain and h the hardening. So its derivative is -e_p, the stress that flowing took away; the energy
/// contains what was dissipated since `before`. [Ortiz & Stainier 1999] Zero below yield.
StretchTerms plastic_terms(const fem::Plasticity& plasticity, const FibreState& before, double lambda);

}  // namespace palpate::skeleton
