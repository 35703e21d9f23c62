#pragma once

#include <vector>

#include "fem/effects/effects.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// What effects in the material make of a limb's or a plate's link: its stiffnesses, and how they depend on one
/// another.
///
/// A section bears (elongation, shears, torsion, flexions) with stiffnesses per length, in the link's axes and of
/// strains e = (gamma_xx, gamma_xy, gamma_xz) = B(y, z) k of its generalized strains k,
///   K = integral over the section of B^T Q B,
/// Q the material's moduli with no stress across the link, scaled so that isotropic material has the torsion of an
/// ellipse and the shear of a beam, as start_stiffness. Along the link softnesses add up, with what bends under shear:
///   K_link^-1 = integral along the link of H^T K^-1 H,   H(s): forces in the middle to those at s.
/// [Hodges 2006] Its factors K_link = C^T D C, C with ones on its diagonal and nothing below, make the link's energy
///   1/2 sum_j k_j m_j (C s)_j^2,   m_j = D_j over what it is without effects,
/// linear in its stiffnesses k, never negative. Fibres at an angle couple elongation with shear and flexion with
/// torsion, a stiff lump beside the axis elongation with flexion.
struct SectionLaw {
    Eigen::Matrix<double, 6, 1> factors = Eigen::Matrix<double, 6, 1>::Ones();       // m, ordered as Stiffness
    Eigen::Matrix<double, 6, 6> coupling = Eigen::Matrix<double, 6, 6>::Identity();  // C [-, mm, 1/mm]
    bool in_force = false;  // else all is as `factors` and `coupling` have it here
};

/// Does an effect act through sections: does it change a material's moduli at rest, and bear nothing there?
bool acts_in_sections(const fem::MaterialEffect& effect, const Vec3& X);

/// Of each link; empty where no effect acts in sections. Paper's links have none, and neither have those of lumps,
/// whose spheres keep their volume: what a lump's link stands for is no beam.
std::vector<SectionLaw> section_laws(const Model& model, const fem::Effects& effects);

}  // namespace palpate::skeleton
