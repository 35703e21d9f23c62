#pragma once

namespace palpate::fem {

/// How a body's stress follows from its deformation gradient F; all agree in small strain.
/// mu: shear modulus, K: bulk modulus; J = det F, E = (F^T F - I) / 2.
enum class MaterialLaw {
    linear,       // small strain: as linear solvers write
    svk,          // St. Venant-Kirchhoff: mu dev(E):dev(E) + K/2 (tr E)^2
    neo_hookean,  // mu/2 (J^-2/3 tr F^T F - 3) + K/2 (J - 1)^2
};

}  // namespace palpate::fem
