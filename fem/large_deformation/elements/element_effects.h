#pragma once

#include <span>

#include "fem/effects/effects.h"
#include "fem/large_deformation/elements/element_shape.h"
#include "fem/large_deformation/elements/material_point.h"
#include "fem/large_deformation/material_law.h"

namespace palpate::fem {

/// What effects there are in the material of one element.
struct ElementEffects {
    Eigen::Vector4d s = Eigen::Vector4d::Ones();  // how many times as stiff it is at each quadrature point [-]
    double mean_s = 1;                            // over its volume [-]
    PointPositions X = PointPositions::Zero();    // where the points rest [mm]

    std::span<const MaterialEffect* const> energies;  // those that add to the energy
    const Plasticity* plasticity = nullptr;           // none: it does not yield
    const Damage* damage = nullptr;                   // none: it stays as stiff as it is
    const MaterialPoint* before = nullptr;            // what each point has been through; none: it is virgin
    bool flows = true;                                // else the plastic strain stays what it was

    /// Do they only scale the law?
    bool is_scale() const { return energies.empty() && !plasticity && !damage; }
    /// What they add to the distortion's energy D at point q; under the linear law to second order about F = I. Plastic
    /// flow and damage take away from it. @pre det F > 0 unless the law is linear; they do not only scale.
    MaterialTerms added(MaterialLaw law, int q, const Mat3& F, bool with_second) const;
};

}  // namespace palpate::fem
