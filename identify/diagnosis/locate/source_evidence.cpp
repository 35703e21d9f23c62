#include "identify/diagnosis/locate/source_evidence.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::identify {
namespace {

/// Prior sizes of a source, in sigmas rms that it alters the readings by.
constexpr std::array<double, 8> sizes{0.03, 0.1, 0.3, 1, 3, 10, 30, 100};

}  // namespace

double independent_errors(double rows, int states) { return std::min(rows, 6.0 * states); }

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
        const double scale2 = rows_ * p / std::max(M.trace(), 1e-300);  // of columns that alter readings by a sigma
        if (!(M.trace() > 1e-12)) {
            one.log_bayes_factor = -INFINITY;
            continue;
        }
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
        double mean = 0;
        for (const double e : evidence) mean += std::exp(e - evidence[best]) / static_cast<double>(sizes.size());
        one.log_bayes_factor = evidence[best] + std::log(mean);

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
        if (one_sided) {
            // Half of the prior lies where the numbers mean nothing.
            constexpr double impossible = -50;
            one.log_bayes_factor = one.mean.sum() > 0 ? one.log_bayes_factor + std::log(2.0) : impossible;
        }
    }
    return result;
}

}  // namespace palpate::identify
