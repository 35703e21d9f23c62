#pragma once

#include "identify/numerics/spectrum.h"

namespace palpate::identify {

struct ConjugateGradients {
    double left = 1e-6;   // of each column's energy x^T (shift + A) x, that may be left to gain,
    double enough = 0;    // or so much of it
    int products = 1000;  // at most
};

struct ShiftedSolution {
    Eigen::MatrixXd X;     // (P x n)
    Eigen::MatrixXd left;  // B - (shift + A) X
    int products = 0;      // with A, of all columns at once
};

/// (shift + A) X = B, B (P x n), preconditioned by the spectrum of an A nearby: a few products where that leaves out
/// what is small beside the shift. Columns share their directions, so that n of them need far fewer products than one.
/// What is left is at most what the spectrum says of the residual, where it holds no more than A does, or else about
/// what the last products gained. [Hestenes & Stiefel 1952; O'Leary 1980 for blocks; Strakos & Tichy 2002 for what is
/// left]
ShiftedSolution solve_shifted(const SymmetricProduct& A, double shift, const Eigen::MatrixXd& B, const Spectrum& near,
                              const ConjugateGradients& options = {});

}  // namespace palpate::identify
