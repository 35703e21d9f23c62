#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::identify {

constexpr double good_r_hat = 1.1;  // beyond it clouds differ by more than chance [Gelman & Rubin 1992]

/// How far two clouds of chains, which know nothing of each other, agree.
struct Convergence {
    double r_hat = 1;      // the largest over the quantities; 1: the clouds are the same
    double effective = 0;  // independent draws that all of them together are worth
};

/// `clouds`: of each, the draws of its chains one after the other, (rounds x chains) columns of quantities (Q x n), a
/// round's chains side by side. [Gelman & Rubin 1992, of two clouds; Flegal & Jones 2010, chains as batches] Mean
/// over the quantities; no more than there are draws.
Convergence convergence(const std::vector<Eigen::MatrixXd>& clouds, int chains);

}  // namespace palpate::identify
