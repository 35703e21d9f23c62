#include "identify/diagnosis/locate/sources/source_evidence.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

/// Prior sizes of a source, in sigmas rms that it alters the readings by: half decades from what no set of some hundred
/// readings shows to a hundred times the noise. The evidence of a weaker or a stronger source is that of the nearest
/// size; each size more costs the evidence of all ln(9/8).
constexpr std::array<double, 8> sizes{0.03, 0.1, 0.3, 1, 3, 10, 30, 100};

}  // namespace

double independent_errors(double rows, int states) {
    constexpr double of_state = 6;  // how far its markers move and turn together
    return std::min(rows, of_state * states);
}

double source_deviance(double chi_square, double rows, double independent) {
    const double excess = chi_square - rows;
    return excess > 0 ? independent * std::log1p(excess / independent) : excess;
}

SourceScore::SourceScore(const Whitening& V, const Eigen::VectorXd& d, int states)
    : V_(V),
      whitened_(V.apply(d)),
      chi_square_(d.dot(whitened_)),
      rows_(static_cast<double>(d.size())),
      independent_(independent_errors(rows_, states)) {}

std::vector<SourceEvidence> SourceScore::operator()(const Eigen::MatrixXd& columns, int p, bool one_sided) const {
    const Eigen::MatrixXd applied = V_.apply(columns);
    const Eigen::VectorXd scores = columns.transpose() * whitened_;
    std::vector<SourceEvidence> result(static_cast<std::size_t>(columns.cols() / p));
    for (std::size_t g = 0; g < result.size(); ++g) {
        const auto at = static_cast<Eigen::Index>(g) * p;
        SourceEvidence& one = result[g];
        const Eigen::MatrixXd M = columns.middleCols(at, p).transpose() * applied.middleCols(at, p);
        one.mean = Eigen::VectorXd::Zero(p);
        one.covariance = Eigen::MatrixXd::Zero(p, p);
        constexpr double rounding = 1e-12;  // square of what all readings together feel of it, in sigmas
        if (!(M.trace() > rounding)) {
            one.log_bayes_factor = -INFINITY;
            continue;
        }
        const double scale2 = rows_ * p / M.trace();  // of columns that alter readings by a sigma
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M * scale2);
        const Eigen::ArrayXd lambda = eigen.eigenvalues().array().max(0);
        const Eigen::ArrayXd s = (eigen.eigenvectors().transpose() * scores.segment(at, p)).array() * std::sqrt(scale2);
        const double without = source_deviance(chi_square_, rows_, independent_);
        std::array<double, sizes.size()> evidence{};
        std::size_t best = 0;
        for (std::size_t t = 0; t < sizes.size(); ++t) {
            const double precision = 1 / (sizes[t] * sizes[t]);
            const double gain = (s.square() / (lambda + precision)).sum();
            evidence[t] = 0.5 * (without - source_deviance(chi_square_ - gain, rows_, independent_)) -
                          0.5 * (lambda / precision).log1p().sum();
            if (evidence[t] > evidence[best]) best = t;
        }
        one.log_bayes_factor = log_mean_exp(evidence);

        const Eigen::ArrayXd precision = lambda + 1 / (sizes[best] * sizes[best]);
        one.mean = std::sqrt(scale2) * (eigen.eigenvectors() * (s / precision).matrix());
        const double gain = (s.square() / precision).sum();
        one.explained = gain / chi_square_;
        const double without_scale = std::max(chi_square_, rows_), with_scale = std::max(chi_square_ - gain, rows_);
        one.log_fit = 0.5 * rows_ * std::log(without_scale / with_scale) -
                      0.5 * (lambda * sizes[best] * sizes[best]).log1p().sum();
        const double s2 = 1 + std::max(0.0, chi_square_ - gain - rows_) / independent_;  // of errors of the model, too
        one.covariance = s2 * scale2 * eigen.eigenvectors() * precision.inverse().matrix().asDiagonal() *
                         eigen.eigenvectors().transpose();
        if (!one_sided) continue;
        one.log_bayes_factor = one_sided_evidence(one.log_bayes_factor, one.mean.sum());
        one.log_fit = one_sided_evidence(one.log_fit, one.mean.sum());
    }
    return result;
}

}  // namespace palpate::identify
