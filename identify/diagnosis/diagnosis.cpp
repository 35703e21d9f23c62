#include "identify/diagnosis/diagnosis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

/// Covariance of what is told of fitted numbers v with a covariance C, to first order: by central differences along
/// each column of C's square root. The steps are a part of a column: a direction's length, which nothing tells, is
/// known to as much as it is long, and a whole step back would end at no direction.
Eigen::MatrixXd covariance_of_told(const EffectHypothesis& effect, const std::vector<EffectNumber>& numbers,
                                   const Eigen::VectorXd& v, const Eigen::MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(covariance);
    const auto estimate = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        const skeleton::EffectRecord at = effect.record(numbers, x);
        Eigen::VectorXd values(std::ssize(at.parameters));
        for (Eigen::Index p = 0; p < values.size(); ++p) values[p] = at.parameters[p].value;
        return values;
    };
    constexpr double step = 0.1;
    Eigen::MatrixXd root(estimate(v).size(), v.size());
    for (Eigen::Index j = 0; j < v.size(); ++j) {
        const Eigen::VectorXd c = std::sqrt(std::max(axes.eigenvalues()[j], 0.0)) * axes.eigenvectors().col(j);
        root.col(j) = (estimate(v + step * c) - estimate(v - step * c)) / (2 * step);
    }
    return root * root.transpose();
}

/// The correlations of the wider of two covariances, with the larger of both variances of each number.
Eigen::MatrixXd wider(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
    const Eigen::MatrixXd& base = one.trace() >= other.trace() ? one : other;
    const Eigen::ArrayXd variance = one.diagonal().cwiseMax(other.diagonal()).array();
    const Eigen::VectorXd stretch =
        (base.diagonal().array() > 0).select((variance / base.diagonal().array()).sqrt(), 0.0);
    Eigen::MatrixXd result = stretch.asDiagonal() * base * stretch.asDiagonal();
    result.diagonal() = variance;
    return result;
}

}  // namespace

std::vector<std::string> FittedExplanation::names() const {
    std::vector<std::string> result;
    result.reserve(effects.size());
    for (const auto& effect : effects) result.push_back(effect->name());
    return result;
}

bool FittedExplanation::has(const std::string& name) const {
    return std::ranges::any_of(effects, [&](const auto& effect) { return effect->name() == name; });
}

EffectEstimate FittedExplanation::estimate(const std::string& name, int which) const {
    const Explanation& all = fit.explanation;
    Eigen::Index at = all.theta.size();
    for (std::size_t e = 0; e < all.effects.size(); ++e) {
        const Eigen::VectorXd& v = all.values[e];
        if (all.effects[e]->name() != name || which-- > 0) {
            at += v.size();
            continue;
        }
        EffectEstimate result{.effect = all.effects[e]->record(fit.numbers[e], v)};
        const auto told = [&](const Eigen::MatrixXd& covariance) {
            return covariance_of_told(*all.effects[e], fit.numbers[e], v, covariance.block(at, at, v.size(), v.size()));
        };
        result.covariance = wider(told(fit.covariance), told(fit.scatter));
        for (const double variance : result.covariance.diagonal()) result.sd.push_back(std::sqrt(variance));
        return result;
    }
    return {};
}

const Refit& Diagnosis::best() const { return explained ? explained->fit : baseline; }

}  // namespace palpate::identify
