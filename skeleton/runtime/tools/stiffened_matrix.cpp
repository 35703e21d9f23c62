#include "skeleton/runtime/tools/stiffened_matrix.h"

#include <Eigen/Cholesky>

namespace palpate::runtime {

StiffenedMatrix::StiffenedMatrix(const std::vector<int>& block_of, Eigen::Index size)
    : block_of_(block_of), size_(size), columns_(static_cast<std::size_t>(size / 6)) {}

void StiffenedMatrix::forget() {
    for (Columns& columns : columns_) columns.is_known = false;
}

void StiffenedMatrix::find_carrying(const StiffRows& stiff) {
    for (const int block : carrying_) columns_[block].place = -1;
    carrying_.clear();
    for (const StiffRows::Move& move : stiff.moves) {
        for (int share = 0; share < move.point->shares(); ++share) {
            const int block = block_of_[move.point->sphere(share)];
            if (block < 0 || columns_[block].place >= 0) continue;
            columns_[block].place = static_cast<int>(carrying_.size());
            carrying_.push_back(block);
        }
    }
}

void StiffenedMatrix::set_rows(const StiffRows& stiff) {
    N_.setZero(std::ssize(stiff.rows), 6 * std::ssize(carrying_));
    auto move = stiff.moves.begin();
    for (std::size_t row = 0; row < stiff.rows.size(); ++row) {
        for (std::size_t i = 0; i < stiff.rows[row].count; ++i, ++move) {
            move->point->jacobians(by_share_);
            for (int share = 0; share < move->point->shares(); ++share) {
                const int block = block_of_[move->point->sphere(share)];
                if (block < 0) continue;
                N_.block<1, 6>(static_cast<Eigen::Index>(row), 6L * columns_[block].place) +=
                    move->along.transpose() * by_share_[share];
            }
        }
    }
}

void StiffenedMatrix::take(const StiffRows& stiff, const Solve& solve) {
    find_carrying(stiff);
    for (const int block : carrying_) {
        Columns& columns = columns_[block];
        if (columns.is_known) continue;
        columns.of.setZero(size_, 6);
        columns.of.middleRows<6>(6L * block).setIdentity();
        for (int c = 0; c < 6; ++c) solve(columns.of.col(c).data());
        columns.is_known = true;
    }
    set_rows(stiff);
    carried_.resize(N_.cols(), N_.cols());
    for (std::size_t a = 0; a < carrying_.size(); ++a) {
        for (std::size_t b = 0; b < carrying_.size(); ++b) {
            carried_.block<6, 6>(6 * static_cast<Eigen::Index>(a), 6 * static_cast<Eigen::Index>(b)) =
                columns_[carrying_[b]].of.middleRows<6>(6L * carrying_[a]);
        }
    }
    S_.resize(N_.rows(), N_.rows());
    S_.noalias() = N_ * carried_ * N_.transpose();
    for (Eigen::Index i = 0; i < S_.rows(); ++i) S_(i, i) += 1 / stiff.rows[static_cast<std::size_t>(i)].stiffness;
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(S_);
}

void StiffenedMatrix::correct(Vector& v) {
    there_.resize(N_.cols());
    for (std::size_t a = 0; a < carrying_.size(); ++a)
        there_.segment<6>(6 * static_cast<Eigen::Index>(a)) = v.segment<6>(6L * carrying_[a]);
    along_.noalias() = N_ * there_;
    S_.triangularView<Eigen::Lower>().solveInPlace(along_);
    S_.transpose().triangularView<Eigen::Upper>().solveInPlace(along_);
    there_.noalias() = N_.transpose() * along_;
    for (std::size_t a = 0; a < carrying_.size(); ++a)
        v.noalias() -= columns_[carrying_[a]].of * there_.segment<6>(6 * static_cast<Eigen::Index>(a));
}

}  // namespace palpate::runtime
