#pragma once

#include <Eigen/Core>
#include <vector>

#include "skeleton/blocks/block_cholesky.h"
#include "skeleton/runtime/contacts/contacts.h"

namespace palpate::runtime {

/// Springs of the contacts that drag, as a change of low rank to a factored matrix A of the free spheres:
/// (A + P^T k P)^-1 by A^-1 P^T [Woodbury], P how the contacts' places follow the spheres. Allocates nothing once a
/// contact has been set.
class Springs {
public:
    Springs() = default;
    /// `block_of`: of each sphere its block in the matrix, -1 where it is held.
    Springs(const std::vector<int>& block_of, Eigen::Index size, int contacts);

    /// Springs, matrix or poses have changed.
    void forget() { known_ = false; }
    bool known() const { return known_; }
    /// Takes up the contacts as they pull at a pose.
    void take(skeleton::BlockCholesky& matrix, const std::vector<ContactState*>& contacts, const double* pose);
    /// z <- (A + P^T k P)^-1 z (6 free).
    void solve(skeleton::BlockCholesky& matrix, double* z);

private:
    struct Spring {
        const ContactState* contact = nullptr;
        std::vector<Eigen::Matrix<double, 3, 6>> by_share;
    };
    Vec3 along(const Spring& spring, const double* z) const;  // P z

    std::vector<int> block_of_;
    bool known_ = false;
    int used_ = 0;
    std::vector<Spring> springs_;  // those in use first
    Eigen::MatrixXd Y_;            // A^-1 P^T (6 free x 3 contacts)
    Eigen::MatrixXd S_;            // k^-1 + P Y, or its Cholesky factor (3 contacts x 3 contacts)
    Eigen::VectorXd Pz_;
};

}  // namespace palpate::runtime
