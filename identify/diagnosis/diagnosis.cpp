#include "identify/diagnosis/diagnosis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

/// Variances of what is told of fitted numbers v with a covariance C: the halves of what it differs by between v + c
/// and v - c, squared, for each column c of C's square root.
Eigen::VectorXd variances_of_told(const EffectHypothesis& effect, const std::vector<EffectNumber>& numbers,
                                  const Eigen::VectorXd& v, const Eigen::MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(covariance);
    const auto estimate = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        const skeleton::EffectRecord at = effect.record(numbers, x);
        Eigen::VectorXd values(std::ssize(at.parameters));
        for (Eigen::Index p = 0; p < values.size(); ++p) values[p] = at.parameters[p].value;
        return values;
    };
    Eigen::VectorXd variances = 0 * estimate(v);
    for (Eigen::Index j = 0; j < v.size(); ++j) {
        const Eigen::VectorXd c = std::sqrt(std::max(axes.eigenvalues()[j], 0.0)) * axes.eigenvectors().col(j);
        variances += (0.5 * (estimate(v + c) - estimate(v - c))).cwiseAbs2();
    }
    return variances;
}

}  // namespace

bool FittedExplanation::has(const std::string& name) const {
    return std::ranges::any_of(effects, [&](const auto& effect) { return effect->name() == name; });
}

EffectEstimate FittedExplanation::estimate(const std::string& name) const {
    const Explanation& all = fit.explanation;
    Eigen::Index at = all.theta.size();
    for (std::size_t e = 0; e < all.effects.size(); ++e) {
        const Eigen::VectorXd& v = all.values[e];
        if (all.effects[e]->name() != name) {
            at += v.size();
            continue;
        }
        EffectEstimate result{all.effects[e]->record(fit.numbers[e], v), {}};
        const auto variances = [&](const Eigen::MatrixXd& covariance) {
            return variances_of_told(*all.effects[e], fit.numbers[e], v, covariance.block(at, at, v.size(), v.size()));
        };
        const Eigen::VectorXd variance = variances(fit.covariance).cwiseMax(variances(fit.scatter));
        for (const double one : variance) result.sd.push_back(std::sqrt(one));
        return result;
    }
    return {};
}

const Refit& Diagnosis::best() const { return explained ? explained->fit : baseline; }

}  // namespace palpate::identify
