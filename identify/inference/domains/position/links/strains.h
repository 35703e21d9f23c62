#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "identify/inference/domains/position/links/link_signatures.h"

namespace palpate::identify {

/// What a unit of each stiffness withstands at rest as a sum over strains, each linear in the step:
///   H_e = sum_j weight_j b_j b_j^T over the strains j of stiffness e.
/// So the gradients of many states by all stiffnesses are two products with one sparse matrix.
struct Strains {
    Eigen::SparseMatrix<double, Eigen::RowMajor> b;  // (J x 6N)
    Eigen::VectorXd weights;                         // (J)
    std::vector<int> of;                             // the stiffness of each (J)

    /// u^T H_e l of each stiffness, summed over the columns of U and L (6N x states). Adds to `sum` (stiffnesses).
    void add_products(const fem::MultiVector& U, const fem::MultiVector& L, Eigen::VectorXd& sum) const;
};

/// Of a model by the linear law; none where its volumes have swollen at rest already, as then they withstand more than
/// one strain each.
std::optional<Strains> strains_of(const LinksAtRest& links);

}  // namespace palpate::identify
