#pragma once

#include <array>

#include "fem/elements/dilatation.h"
#include "fem/large_deformation/body_setting.h"
#include "fem/large_deformation/elements/element_effects.h"
#include "fem/large_deformation/elements/element_shape.h"

namespace palpate::fem {

/// Displacements or forces of an element's nodes, a column each.
using NodeVectors = Eigen::Matrix<double, 3, element_nodes, Eigen::RowMajor>;

/// How elements answer.
struct ElementModel {
    MaterialLaw law;
    double mu, K;      // shear and bulk modulus [MPa]
    double K_over_mu;  // of the material, whatever moduli stand for it
    Dilatation dilatation;

    ElementModel(const BodySetting& setting, Dilatation dilatation);
    /// The moduli of a material.
    void take(const Material& material);

    /// The part of the bulk modulus that answers to the volume change v at each point; what is left of it answers to
    /// the mean over the element, which does not lock near nu = 0.5.
    /// With mean dilatation that is lambda, as in small strain: K/2 v^2 splits into mu/3 v^2 + lambda/2 (mean v)^2.
    /// With all of K on the mean, coarse meshes are 3 to 5 times as far off. An element that is alone in the thickness
    /// of a plate bends as if nu were 0 then, 20 % too easily at 0.45: thin ones answer at each point with a lambda of
    /// up to 4 mu, that of nu = 0.4, which does not lock. They are within 5 % for every ratio up to 0.49
    /// (tests/fem/large_deformation/elements/dilatation_test.cpp).
    double local_bulk() const {
        constexpr double most = 14.0 / 3;  // of K over mu, at nu = 0.4
        if (dilatation == Dilatation::mean) return 2 * mu / 3;
        const bool is_full = dilatation == Dilatation::full || K_over_mu <= most;
        return is_full ? K : most * mu;
    }
};

/// Derivative of an element's internal forces f_ic by the displacements u_jd, i and j nodes, c and d components.
struct ElementTangent {
    using NodePairs = Eigen::Matrix<double, element_nodes, element_nodes, Eigen::RowMajor>;
    std::array<NodePairs, 6> blocks;  // of the components (c, d) = 00, 01, 02, 11, 12, 22; the others mirror them

    static int block_of(int c, int d) { return 3 * c - c * (c - 1) / 2 + d - c; }  // c <= d
    double operator()(int i, int c, int j, int d) const {
        return c <= d ? blocks[block_of(c, d)](i, j) : blocks[block_of(d, c)](j, i);
    }
};

/// An element's energy by its nodes' displacements, and the internal forces, its gradient. Infinite, and no forces,
/// when it is inside out. `effects`: in its material, nullptr: none. With them the energy is
///   sum_q w_q s_q (mu (D + w) + local/2 v^2) + mean s V (K - local)/2 (mean v)^2.
double element_force(const ElementShape& shape, const ElementModel& model, const ElementEffects* effects,
                     const NodeVectors& u, NodeVectors& f);

/// The second derivative. @pre the element is not inside out.
void element_tangent(const ElementShape& shape, const ElementModel& model, const ElementEffects* effects,
                     const NodeVectors& u, ElementTangent& K);

}  // namespace palpate::fem
