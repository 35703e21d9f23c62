#include "identify/diagnosis/likelihood/whitening.h"

#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace palpate::identify {
namespace {

double log_determinant_of(const Eigen::LLT<Eigen::MatrixXd>& factor) {
    return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

Whitening::Whitening(Eigen::VectorXd weights, const Eigen::MatrixXd& A, Eigen::VectorXd precisions)
    : weights_(std::move(weights)), precisions_(std::move(precisions)), B_(weights_.asDiagonal() * A) {
    assert(A.cols() == precisions_.size() && A.rows() == weights_.size());
    if (B_.cols() > 0) {
        Eigen::MatrixXd inner = precisions_.asDiagonal();
        inner.selfadjointView<Eigen::Lower>().rankUpdate(B_.transpose());
        inner_.compute(inner);
    }
    // |V| = |W^-2| |Lambda + B^T B| / |Lambda|
    log_determinant_ = (B_.cols() > 0 ? log_determinant_of(inner_) : 0) - precisions_.array().log().sum() -
                       2 * weights_.array().log().sum();
}

Eigen::MatrixXd Whitening::apply(const Eigen::MatrixXd& b) const {
    Eigen::MatrixXd weighted = weights_.asDiagonal() * b;
    if (B_.cols() > 0) weighted -= B_ * inner_.solve(B_.transpose() * weighted);
    return weights_.asDiagonal() * weighted;
}

Eigen::VectorXd Whitening::nuisances(const Eigen::VectorXd& d) const {
    if (B_.cols() == 0) return {};
    return inner_.solve(B_.transpose() * weights_.cwiseProduct(d)).cwiseProduct(precisions_.cwiseSqrt());
}

Eigen::VectorXd Whitening::residual(const Eigen::VectorXd& d) const {
    const Eigen::VectorXd weighted = weights_.cwiseProduct(d);
    if (B_.cols() == 0) return weighted;
    return weighted - B_ * inner_.solve(B_.transpose() * weighted);
}

Eigen::MatrixXd Whitening::solve_within(const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& y) const {
    const Eigen::VectorXd unweighted = weights_(rows).cwiseInverse();
    Eigen::MatrixXd x = unweighted.asDiagonal() * y;
    if (B_.cols() > 0) {
        const Eigen::MatrixXd own = B_(rows, Eigen::all);
        Eigen::MatrixXd others = inner_.reconstructedMatrix();
        others.selfadjointView<Eigen::Lower>().rankUpdate(own.transpose(), -1);
        x += own * others.selfadjointView<Eigen::Lower>().llt().solve(own.transpose() * x);
    }
    return unweighted.asDiagonal() * x;
}

Eigen::MatrixXd Whitening::absorbed() const {
    if (B_.cols() == 0) return Eigen::MatrixXd(0, weights_.size());
    return inner_.matrixL().solve((weights_.asDiagonal() * B_).transpose());
}

Eigen::VectorXd Whitening::nuisance_sd() const {
    // In sigmas: the nuisances' share A Lambda^-1 A^T, and what a weight below 1 stands for, W^-2 - 1.
    const Eigen::VectorXd of_weights = weights_.array().square().inverse() - 1;
    if (B_.cols() == 0) return of_weights.cwiseSqrt();
    const Eigen::MatrixXd A = weights_.cwiseInverse().asDiagonal() * B_;
    return ((A * precisions_.cwiseSqrt().cwiseInverse().asDiagonal()).rowwise().squaredNorm() + of_weights).cwiseSqrt();
}

Whitening noise_alone(Eigen::Index N) { return {Eigen::VectorXd::Ones(N), Eigen::MatrixXd(N, 0), Eigen::VectorXd(0)}; }

ScreenResult screen(const Whitening& V, const Eigen::VectorXd& d, const Eigen::MatrixXd& b,
                    const Eigen::VectorXd& tau) {
    return screen_alternatives(V, d, b, tau).front();
}

std::vector<ScreenResult> screen_alternatives(const Whitening& V, const Eigen::VectorXd& d, const Eigen::MatrixXd& b,
                                              const Eigen::VectorXd& tau) {
    const Eigen::Index p = tau.size(), count = b.cols() / p;
    const Eigen::MatrixXd scaled = b * tau.replicate(count, 1).asDiagonal();
    const Eigen::MatrixXd Vb = V.apply(scaled);
    const Eigen::VectorXd all_s = Vb.transpose() * d;
    const Eigen::VectorXd alone = (V.weights().asDiagonal() * scaled).colwise().squaredNorm();
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(p, p);
    std::vector<ScreenResult> results;
    results.reserve(count);
    for (Eigen::Index a = 0; a < count; ++a) {
        const Eigen::MatrixXd M = scaled.middleCols(a * p, p).transpose() * Vb.middleCols(a * p, p);
        const Eigen::LLT<Eigen::MatrixXd> inner(one + M);
        const Eigen::VectorXd s = all_s.segment(a * p, p), x = inner.solve(s);
        const double all = alone.segment(a * p, p).sum();
        results.push_back({.log_bayes_factor = 0.5 * s.dot(x) - 0.5 * log_determinant_of(inner),
                           .value = x.cwiseProduct(tau),
                           .sd = inner.solve(one).diagonal().cwiseSqrt().cwiseProduct(tau),
                           .identifiable = all > 0 ? M.trace() / all : 0});
    }
    return results;
}

double one_sided_evidence(double log_bayes_factor, double estimate) {
    constexpr double impossible = -50;
    return estimate > 0 ? log_bayes_factor + std::numbers::ln2 : impossible;
}

LeftOutErrors leave_out(const Whitening& V, const Eigen::MatrixXd& d, const std::vector<int>& group) {
    const Eigen::MatrixXd y = V.apply(d);
    LeftOutErrors result{Eigen::MatrixXd::Zero(d.rows(), d.cols()), Eigen::VectorXd::Zero(d.cols())};
    std::map<int, std::vector<Eigen::Index>> rows;
    for (std::size_t n = 0; n < group.size(); ++n) rows[group[n]].push_back(static_cast<Eigen::Index>(n));
    for (const auto& [id, own] : rows) {
        const Eigen::MatrixXd of_group = y(own, Eigen::all), error = V.solve_within(own, of_group);
        result.chi_square += error.cwiseProduct(of_group).colwise().sum();
        result.error(own, Eigen::all) = error;
    }
    return result;
}

}  // namespace palpate::identify
