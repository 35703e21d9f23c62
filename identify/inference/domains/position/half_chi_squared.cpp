#include "identify/inference/domains/position/position_domain.h"

namespace palpate::identify {

double PositionDomain::half_chi_squared(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient,
                                        const Prediction* start) const {
    if (has_adjoint_gradient()) return half_chi_squared_linear(theta, gradient);
    const Prediction prediction = predict(theta, 1, start, true);
    gradient = jacobian(theta, prediction, 1).gradient();
    return chi_squared(prediction) / 2;
}

double PositionDomain::half_chi_squared_linear(const Eigen::VectorXd& theta, Eigen::VectorXd& gradient) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const auto factor = linear_statics_->factor(k);
    const fem::MultiVector U = factor->solve(F_.colwise() + G_rest_ * k);

    // K u = F + G_rest k, so that half of chi^2 rises by l^T (H_e u - G_rest e) with k_e, where K l = P^T W error
    fem::MultiVector pulls = fem::MultiVector::Zero(U.rows(), U.cols());
    double half = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Eigen::VectorXd moved = *P_[s] * U.col(s);
        const Points markers = states_[s].rest + offsets_[s] + moved.reshaped<Eigen::RowMajor>(moved.size() / 3, 3);
        const Eigen::VectorXd error = errors(s, markers), weighted = weights_[s].cwiseProduct(error);
        half += error.dot(weighted) / 2;
        pulls.col(s) = P_[s]->transpose() * weighted;
    }
    const fem::MultiVector L = factor->solve(pulls);
    Eigen::VectorXd by_k = -(G_rest_.transpose() * L.rowwise().sum());
    strains_->add_products(U, L, by_k);
    gradient.setZero(parameters_.size());
    for (Eigen::Index e = 0; e < k.size(); ++e) {
        const int p = parameters_.parameter_of[e];
        if (p >= 0) gradient[p] += k[e] * by_k[e];
    }
    return half;
}

}  // namespace palpate::identify
