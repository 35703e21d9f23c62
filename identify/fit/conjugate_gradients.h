#pragma once

#include "identify/fit/spectrum.h"

namespace palpate::identify {

struct ConjugateGradients {
    double residual = 1e-3;  // of each column, that may be left of its right-hand side
    int products = 1000;     // at most
};

struct ShiftedSolution {
    Eigen::MatrixXd X;     // (P x n)
    Eigen::MatrixXd left;  // B - (shift + A) X
    int products = 0;      // with A, of all columns at once
};

/// (shift + A) X = B, B (P x n), columns side by side, preconditioned by the spectrum of an A nearby: a few products
/// where that leaves out what is small beside the shift. [Hestenes & Stiefel 1952]
ShiftedSolution solve_shifted(const SymmetricProduct& A, double shift, const Eigen::MatrixXd& B, const Spectrum& near,
                              const ConjugateGradients& options = {});

}  // namespace palpate::identify
