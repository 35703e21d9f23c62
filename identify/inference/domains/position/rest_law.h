#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "fem/linear_algebra/cholesky/cholesky.h"
#include "identify/inference/domains/position/links/link_signatures.h"
#include "skeleton/statics/matrices/block_structure.h"

namespace palpate::identify {

/// The linear law of a model for one vector k of stiffnesses after another: steps u from rest with K(k) u = F,
///   K(k) = K_0 + sum_e k_e H_e,
/// where H_e, what a unit of a stiffness withstands at rest, and K_0, of effects, are found once. Factors by supernodes
/// [fem::Cholesky], so that ten thousand links and many right-hand sides are products of dense blocks. Safe from
/// several threads.
class LinearStatics {
public:
    /// The model's effects are in force. @throws InvalidInput as skeleton::StaticsSolver.
    explicit LinearStatics(const skeleton::Model& model);

    /// K(k), factored; gives its memory back when it goes.
    class Factor;
    /// @throws SolverFailure naming the sphere that nothing keeps in place.
    std::shared_ptr<const Factor> factor(const Eigen::VectorXd& k) const;

    const std::shared_ptr<const LinksAtRest>& links() const { return links_; }

private:
    /// What a factor needs of its law, and leaves to the next one.
    struct FactorPool {
        FactorPool(const std::vector<int>& free, const std::vector<std::array<int, 2>>& pairs);

        std::vector<int> free;  // spheres
        skeleton::BlockStructure structure;
        std::mutex mutex;
        std::vector<std::unique_ptr<fem::Cholesky>> idle;
    };

    fem::LowerMatrix matrix(const Eigen::VectorXd& k) const;
    void add(int a, int b, const skeleton::BlockStructure::Block& block, fem::LowerMatrix& K) const;

    skeleton::Model model_;
    std::shared_ptr<const LinksAtRest> links_;
    std::shared_ptr<FactorPool> pool_;
    std::vector<int> number_;  // among the free spheres, of each; -1: held
    fem::LowerMatrix K_0_;     // with room for all of K
};

class LinearStatics::Factor {
public:
    explicit Factor(std::shared_ptr<FactorPool> pool);
    ~Factor();
    Factor(const Factor&) = delete;
    Factor& operator=(const Factor&) = delete;
    /// K^-1 F (6N x p); rows of held spheres are ignored in F and zero in the result.
    fem::MultiVector solve(const fem::MultiVector& F) const;

private:
    friend class LinearStatics;
    std::shared_ptr<FactorPool> pool_;
    std::unique_ptr<fem::Cholesky> factor_;
};

}  // namespace palpate::identify
