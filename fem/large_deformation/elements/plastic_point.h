#pragma once

#include "fem/effects/effects.h"
#include "fem/large_deformation/material_law.h"

namespace palpate::fem {

/// Plastic state of one material point.
struct PlasticPoint {
    /// Its plastic strain, deviatoric or unimodular. Neo-Hookean: L - I with L lower triangular, L L^T the inverse
    /// of the plastic right Cauchy-Green tensor; St. Venant-Kirchhoff's: a part of E; linear: of the strain. Zero:
    /// none.
    Mat3 set = Mat3::Zero();
    double alpha = 0;  // equivalent plastic strain so far [-]
};

/// What plastic strain and flow change in the law's distortion D at F: its stress returns to the yield surface along
/// the normal, at once from where it was `before`; without `flows` the plastic strain stays. `second` is the consistent
/// tangent's symmetric part. Exact for the neo-Hookean law in large strain [Simo & Hughes 1998, boxes 9.1 and 9.2]; the
/// other laws take the plastic strain off their own, which is right while strains are small [box 3.2].
/// w is a potential of `first` for the latter; for the neo-Hookean law there is none, and it is one but for terms of
/// the third order in elastic strains.
MaterialTerms plastic_terms(MaterialLaw law, const Plasticity& plasticity, const PlasticPoint& before, const Mat3& F,
                            bool flows, bool with_second);

/// Updated plastic state after deformation F.
PlasticPoint plastic_point(MaterialLaw law, const Plasticity& plasticity, const PlasticPoint& before, const Mat3& F);

}  // namespace palpate::fem
