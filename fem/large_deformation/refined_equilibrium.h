#pragma once

#include <Eigen/SparseCore>
#include <optional>

#include "fem/hyperelastic_body.h"

namespace palpate::fem {

/// A body on a finer mesh, as one of halved edges (fem/interpolation/refine.h), and how it follows from a coarser one.
struct RefinedBody {
    const HyperelasticBody& body;                                       // on the finer mesh
    const Eigen::SparseMatrix<double, Eigen::RowMajor>& interpolation;  // coarse fields at its nodes (n' x n)
};

/// Where the finer body stands in a state whose equilibrium on the coarse mesh is `coarse` (3n), with the tangent J
/// there, under the dead load f on the finer nodes (3n'): by Newton's method, solved on two grids. It ends once
/// a twentieth of the difference between the two meshes is left to go, by the
/// preconditioner's estimate.
/// @return (3n'); nothing where it does not get there, as where elements turn inside out under a sharp contact, and
/// where effects release what is held.
std::optional<Eigen::VectorXd> refined_equilibrium(const RefinedBody& refined, const Eigen::VectorXd& coarse,
                                                   const BodyTangent& J, const BodySetting& setting,
                                                   const Eigen::VectorXd& f);

}  // namespace palpate::fem
