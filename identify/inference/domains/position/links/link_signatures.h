#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "fem/linear_algebra/cholesky/cholesky.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// How a model's links stand at rest, as products with many stiffnesses and steps need it.
struct LinksAtRest {
    skeleton::PlacedLinks placed;
    skeleton::State state;
    skeleton::StiffnessOrder order;
    std::vector<std::array<int, 2>> ends;  // spheres of each link (L)
    Eigen::MatrixXd gradients;             // of the energies at unit stiffness, by the ends' step (12 x per_link L)

    // Second derivatives of these energies, sum_j weight_j f_j f_j^T over a few vectors f_j: an elongation has one.
    // For the linear law alone.
    Eigen::MatrixXd strains;          // f (12 x strains)
    Eigen::VectorXd weights;          // (strains)
    std::vector<int> kind;            // which of its link's stiffnesses each belongs to (strains)
    std::vector<Eigen::Index> first;  // of each link (L + 1)

    /// The model's effects are in force.
    explicit LinksAtRest(const skeleton::Model& model);
};

/// G = d net force / d k in one configuration (6N x stiffnesses): what a unit of each stiffness adds. Kept as twelve
/// numbers a link's stiffness, so that products go link by link, with several vectors at once.
class LinkSignatures {
public:
    /// In an equilibrium, by the law of the model that `links` came from.
    LinkSignatures(std::shared_ptr<const LinksAtRest> links, const skeleton::Equilibrium& equilibrium,
                   skeleton::EquilibriumLaw law);

    Eigen::Index dofs() const { return of_volumes_.rows(); }             // 6N
    fem::MultiVector times(const fem::MultiVector& K) const;             // G K (6N x n), of K (stiffnesses x n)
    fem::MultiVector transposed_times(const fem::MultiVector& F) const;  // G^T F (stiffnesses x n), of F (6N x n)

private:
    std::shared_ptr<const LinksAtRest> links_;
    Eigen::MatrixXd of_links_;                // (12 x per_link L)
    Eigen::SparseMatrix<double> of_volumes_;  // (6N x stiffnesses), of the spheres' alone
};

}  // namespace palpate::identify
