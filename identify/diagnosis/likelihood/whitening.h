#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace palpate::identify {

/// Residuals in sigmas, with the nuisances marginalised:
///   V = W^-2 + A Lambda^-1 A^T
/// with W (N) the weights (below 1 where a coarse model is unsure), A (N x c) what each nuisance does, over sigma, and
/// Lambda (c) their prior precisions. All by V^-1 = W (1 - B (B^T B + Lambda)^-1 B^T) W, B = W A. [Woodbury]
class Whitening {
public:
    Whitening(Eigen::VectorXd weights, const Eigen::MatrixXd& A, Eigen::VectorXd precisions);

    /// V^-1 b (N x p).
    Eigen::MatrixXd apply(const Eigen::MatrixXd& b) const;
    /// d^T V^-1 d of errors d (N), and its root over N: 1 where they are noise.
    double chi_square(const Eigen::VectorXd& d) const { return d.dot(apply(d).col(0)); }
    double rms(const Eigen::VectorXd& d) const { return std::sqrt(chi_square(d) / static_cast<double>(d.size())); }
    double log_determinant() const { return log_determinant_; }
    /// The most probable nuisances behind errors d, in their prior standard deviations (c).
    Eigen::VectorXd nuisances(const Eigen::VectorXd& d) const;
    /// d less what the nuisances explain of it, weighted: with the right model, noise of 1 sigma (N).
    Eigen::VectorXd residual(const Eigen::VectorXd& d) const;
    /// [V^-1]_gg^-1 y for some rows g (n) and y (n x p), at the price of one factorisation of the nuisances: it is
    ///   W_g^-1 (1 + B_g (B^T B + Lambda - B_g^T B_g)^-1 B_g^T) W_g^-1. [Woodbury]
    Eigen::MatrixXd solve_within(const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& y) const;
    /// G (c x N) of V^-1 = W^2 - G^T G: blocks of V^-1 at the price of a product.
    Eigen::MatrixXd absorbed() const;
    const Eigen::VectorXd& weights() const { return weights_; }
    /// Prior standard deviation of each error by nuisances (N), in sigmas of noise; noise itself not
    /// counted.
    Eigen::VectorXd nuisance_sd() const;

private:
    Eigen::VectorXd weights_, precisions_;
    Eigen::MatrixXd B_;                  // W A
    Eigen::LLT<Eigen::MatrixXd> inner_;  // B^T B + Lambda
    double log_determinant_ = 0;
};

/// V of noise alone, 1 sigma each (N).
Whitening noise_alone(Eigen::Index N);

/// The evidence of columns b (N x p) with prior standard deviations tau (p), beside no such effect:
///   s = b^T V^-1 d, M = b^T V^-1 b: ln BF = s^T (M + tau^-2)^-1 s / 2 - ln |1 + tau M tau| / 2.
struct ScreenResult {
    double log_bayes_factor = 0;
    Eigen::VectorXd value, sd;  // expected numbers and their posterior standard deviations (p)
    double identifiable = 0;  // b^T V^-1 b / b^T W^2 b: share of the signature that the nuisances cannot absorb, [0, 1]
};
ScreenResult screen(const Whitening& V, const Eigen::VectorXd& d, const Eigen::MatrixXd& b, const Eigen::VectorXd& tau);

/// The same for alternatives, each a group of p columns side by side (N x alternatives p), all at once.
std::vector<ScreenResult> screen_alternatives(const Whitening& V, const Eigen::VectorXd& d, const Eigen::MatrixXd& b,
                                              const Eigen::VectorXd& tau);

/// The same evidence of numbers that mean nothing below 0, out of that under the symmetric prior and their estimate.
///
/// The half of the prior that counts is twice as dense, and the posterior lies in it by a share of Phi(estimate / sd):
/// ln 2 + ln Phi more. Instead of Phi a step is taken at 0, which differs from it within two sd. Design choice: what is
/// estimated below 0 is out, as if by ten sd (ln 2 Phi(-10) = -52); finite, so that alternatives of which all are out
/// still have a mean.
double one_sided_evidence(double log_bayes_factor, double estimate);

/// Errors d (N x p) of each group of rows (ids >= 0, N) as predicted from all the others: [V^-1]_gg^-1 [V^-1 d]_g.
struct LeftOutErrors {
    Eigen::MatrixXd error;       // (N x p), in sigmas of noise
    Eigen::VectorXd chi_square;  // (p) of the same, group by group whitened by how well it can be predicted
};
LeftOutErrors leave_out(const Whitening& V, const Eigen::MatrixXd& d, const std::vector<int>& group);

}  // namespace palpate::identify
