#include "identify/diagnosis/fit/fit_priors.h"

#include <algorithm>

namespace palpate::identify {

FitPriors::FitPriors(const BodyModel& model, const Explanation& explanation,
                     const std::vector<std::vector<EffectNumber>>& numbers) {
    const Eigen::VectorXd start = explanation.all();
    constexpr double factor_of_two = 0.7;
    const auto n = start.size();
    for (Eigen::VectorXd* column : {&mean, &sd, &least, &most, &step}) column->resize(n);
    Eigen::Index i = 0;
    for (const StiffnessParameter& p : model.parameters()) {
        mean[i] = p.prior_mean;
        sd[i] = p.prior_sd;
        least[i] = p.least;
        most[i] = p.most;
        step[i++] = std::min(p.prior_sd, factor_of_two);
    }
    for (const auto& list : numbers) {
        for (const EffectNumber& number : list) {
            if (number.weakly_identified) weakly_identified.push_back(i);
            mean[i] = number.prior_at_start ? start[i] : number.prior_mean;
            sd[i] = number.prior_sd;
            least[i] = number.least;
            most[i] = INFINITY;
            step[i++] = number.logarithm ? std::min(number.prior_sd, factor_of_two) : number.prior_sd;
        }
    }
}

std::optional<FitPriors> FitPriors::with_magnitude(const Explanation& explanation) const {
    Eigen::Index first = explanation.theta.size();
    for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
        if (const auto known = explanation.effects[e]->magnitude()) {
            FitPriors result = *this;
            result.magnitude_ = {first, *known};
            return result;
        }
        first += explanation.values[e].size();
    }
    return std::nullopt;
}

Eigen::VectorXd FitPriors::precisions() const {
    Eigen::VectorXd result = sd.cwiseAbs2().cwiseInverse();
    if (magnitude_) result.segment<3>(magnitude_->first).setZero();
    return result;
}

double FitPriors::objective(const Eigen::VectorXd& x) const {
    const double normal = 0.5 * (x - mean).cwiseAbs2().dot(precisions());
    if (!magnitude_) return normal;
    const double off = (x.segment<3>(magnitude_->first).norm() - magnitude_->prior.mean) / magnitude_->prior.sd;
    return normal + 0.5 * off * off;
}

Eigen::VectorXd FitPriors::slope(const Eigen::VectorXd& x) const {
    Eigen::VectorXd result = precisions().cwiseProduct(x - mean);
    if (!magnitude_) return result;
    const Vec3 v = x.segment<3>(magnitude_->first);
    const auto& [known, width] = magnitude_->prior;
    if (v.norm() > 0) result.segment<3>(magnitude_->first) += (v.norm() - known) / (width * width) * v.normalized();
    return result;
}

Eigen::MatrixXd FitPriors::precision(const Eigen::VectorXd& x) const {
    Eigen::MatrixXd result = precisions().asDiagonal();
    if (!magnitude_) return result;
    const Vec3 along = x.segment<3>(magnitude_->first).normalized();
    result.block<3, 3>(magnitude_->first, magnitude_->first) +=
        along * along.transpose() / (magnitude_->prior.sd * magnitude_->prior.sd);
    return result;
}

double FitPriors::log_scale() const {
    double result = sd.array().log().sum();
    if (!magnitude_) return result;
    result -= sd.segment<3>(magnitude_->first).array().log().sum();
    // p = exp(...) / (4 pi |v|^2 sqrt(2 pi) sd), against (2 pi)^(3/2) of three numbers
    const auto& [known, width] = magnitude_->prior;
    return result + std::log(2 * known * known * width);
}

double FitPriors::magnitude_in_sd(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) const {
    const Vec3 v = x.segment<3>(magnitude_->first), along = v.normalized();
    const double variance = along.dot(covariance.block<3, 3>(magnitude_->first, magnitude_->first) * along);
    return std::abs(v.norm() - magnitude_->prior.mean) / std::hypot(magnitude_->prior.sd, std::sqrt(variance));
}

}  // namespace palpate::identify
