#pragma once

#include <vector>

#include "identify/diagnosis/likelihood/whitening.h"

namespace palpate::identify {

/// What some columns, with numbers of unknown size, explain of errors d.
struct SourceEvidence {
    double log_bayes_factor = 0;
    double log_fit = 0;          // the same, to choose among places: every reading counts, whatever is left
    double explained = 0;        // share of d^T V^-1 d
    Eigen::VectorXd mean;        // of the numbers (p)
    Eigen::MatrixXd covariance;  // (p x p)
};

/// Numbers that the errors of a model next to a source have, among readings (`rows`) from so many states, and -2 ln p
/// of what is left of the readings: see SourceScore.
double independent_errors(double rows, int states);
double source_deviance(double chi_square, double rows, double independent);

/// Evidence of columns (N x p) against no source, where neither the errors of the model next to a source nor the
/// source's size are known:
///   d ~ N(0, V + M + tau^2 B B^T),  tau in decades from below the noise to far above it, equally likely,
/// B the columns, scaled to one sigma rms. A first-order model of a strong source leaves part of it, as a smooth error
/// M of N_e independent numbers, six for each state: by how much its markers move and turn together. At its most
/// probable size, chi^2 is what the source and the nuisances leave,
///   -2 ln p = N_e ln(1 + (chi^2 - N) / N_e)  above N,  chi^2 - N  below it:
/// next to the noise each reading counts, far above it no more than six numbers of a state. Sources that differ in
/// nothing but their place share such errors: among them N ln chi^2 decides (log_fit).
class SourceScore {
public:
    /// `states`: among which the readings are divided.
    SourceScore(const Whitening& V, const Eigen::VectorXd& d, int states);

    /// Groups of p columns side by side, each by itself (N x groups p). `one_sided`: numbers below 0 mean nothing.
    std::vector<SourceEvidence> operator()(const Eigen::MatrixXd& columns, int p, bool one_sided = false) const;

    double chi_square() const { return chi_square_; }

private:
    const Whitening& V_;
    Eigen::VectorXd whitened_;  // V^-1 d
    double chi_square_, rows_, independent_;
};

}  // namespace palpate::identify
