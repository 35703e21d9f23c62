#include "skeleton/runtime/contacts/springs.h"

#include <Eigen/Cholesky>

namespace palpate::runtime {

Springs::Springs(const std::vector<int>& block_of, Eigen::Index size, int contacts)
    : block_of_(block_of), springs_(contacts) {
    Y_.setZero(size, Eigen::Index{3} * contacts);
    S_.setZero(Eigen::Index{3} * contacts, Eigen::Index{3} * contacts);
    Pz_.setZero(Eigen::Index{3} * contacts);
}

Vec3 Springs::along(const Spring& spring, const double* z) const {
    Vec3 sum = Vec3::Zero();
    for (int s = 0; s < spring.contact->at.shares(); ++s) {
        const int block = block_of_[spring.contact->at.sphere(s)];
        if (block >= 0) sum += spring.by_share[s] * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(z + 6L * block);
    }
    return sum;
}

void Springs::take(skeleton::BlockCholesky& matrix, const std::vector<ContactState*>& contacts, const double* pose) {
    known_ = true;
    used_ = 0;
    for (ContactState* contact : contacts) {
        if (!contact->used || contact->mode != ContactState::Mode::drag) continue;
        Spring& spring = springs_[used_];
        spring.contact = contact;
        contact->at.place(pose);
        contact->at.jacobians(spring.by_share);
        for (int axis = 0; axis < 3; ++axis) {
            auto column = Y_.col(3 * used_ + axis);
            column.setZero();
            for (int s = 0; s < contact->at.shares(); ++s) {
                const int block = block_of_[contact->at.sphere(s)];
                if (block >= 0) column.segment<6>(6L * block) += spring.by_share[s].row(axis).transpose();
            }
            matrix.solve(column.data());
        }
        ++used_;
    }
    const Eigen::Index size = 3L * used_;
    if (size == 0) return;
    auto S = S_.topLeftCorner(size, size);
    for (int s = 0; s < used_; ++s) {
        const ContactState& contact = *springs_[s].contact;
        for (Eigen::Index c = 0; c < size; ++c) S.col(c).segment<3>(3L * s) = along(springs_[s], Y_.col(c).data());
        S.diagonal().segment<3>(3L * s).array() += 1 / (contact.gain * contact.stiffness);
    }
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(S);
}

// z - Y (k^-1 + P Y)^-1 P z of z = A^-1 z.
void Springs::solve(skeleton::BlockCholesky& matrix, double* z) {
    matrix.solve(z);
    const Eigen::Index size = 3L * used_;
    if (size == 0) return;
    for (int s = 0; s < used_; ++s) Pz_.segment<3>(3L * s) = along(springs_[s], z);
    const auto L = S_.topLeftCorner(size, size);
    auto y = Pz_.head(size);
    L.triangularView<Eigen::Lower>().solveInPlace(y);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(y);
    Eigen::Map<Eigen::VectorXd> all(z, Y_.rows());
    for (Eigen::Index c = 0; c < size; ++c) all -= y[c] * Y_.col(c);
}

}  // namespace palpate::runtime
