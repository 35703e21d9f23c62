#include "identify/inference/priors/log_normal_prior.h"

#include <cmath>
#include <numbers>

namespace palpate::identify {

Eigen::VectorXd LogNormalPrior::whitened(const Eigen::VectorXd& theta) const {
    const Eigen::VectorXd scaled = (theta - mean).cwiseQuotient(sd);
    return field ? Eigen::VectorXd(field->whitened(scaled)) : scaled;
}

double LogNormalPrior::half_square(const Eigen::VectorXd& theta) const { return whitened(theta).squaredNorm() / 2; }

double LogNormalPrior::log_density(const Eigen::VectorXd& theta) const {
    return -half_square(theta) - log_root() - 0.5 * static_cast<double>(mean.size()) * std::log(2 * std::numbers::pi);
}

double LogNormalPrior::log_root() const { return sd.array().log().sum() + (field ? field->log_root() : 0); }

Eigen::SparseMatrix<double> LogNormalPrior::precision() const {
    Eigen::SparseMatrix<double> inner(sd.size(), sd.size());
    inner.setIdentity();
    if (field) inner = field->precision();
    return sd.cwiseInverse().asDiagonal() * inner * sd.cwiseInverse().asDiagonal();
}

Eigen::VectorXd LogNormalPrior::precision_times(const Eigen::VectorXd& X) const {
    const Eigen::VectorXd scaled = X.cwiseQuotient(sd);
    return (field ? field->precision_times(scaled) : scaled).cwiseQuotient(sd);
}

Eigen::MatrixXd LogNormalPrior::coloured(const Eigen::MatrixXd& V) const {
    return sd.asDiagonal() * (field ? field->coloured(V) : V);
}

Eigen::MatrixXd LogNormalPrior::gradients_by_v(const Eigen::MatrixXd& jacobian) const {
    const Eigen::MatrixXd scaled = sd.asDiagonal() * jacobian;
    return field ? field->transposed(scaled) : scaled;
}

}  // namespace palpate::identify
