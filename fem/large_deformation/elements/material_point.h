#pragma once

#include <optional>

#include "fem/large_deformation/elements/plastic_point.h"

namespace palpate::fem {

/// What one material point has been through.
struct MaterialPoint {
    PlasticPoint plastic;
    double most = 0;  // greatest energy of distortion that it has borne, over the shear modulus [-]
};

/// What damage changes in the law's distortion D at F, which flow has changed by `flow` already: that of elastic strain
/// is what it acts on. `most`: MaterialPoint's. `second` is symmetric; w is a potential of `first` where D and `flow`
/// have one.
MaterialTerms damage_terms(MaterialLaw law, const Damage& damage, double most, const Mat3& F, const MaterialTerms& flow,
                           bool with_second);

/// The state after deformation F.
MaterialPoint material_point(MaterialLaw law, const std::optional<Plasticity>& plasticity,
                             const std::optional<Damage>& damage, const MaterialPoint& before, const Mat3& F);

}  // namespace palpate::fem
