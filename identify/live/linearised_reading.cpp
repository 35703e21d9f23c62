#include "identify/live/linearised_reading.h"

#include <Eigen/LU>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

constexpr int most_of_a_reading = 32;  // directions that one reading tells about

}  // namespace

LinearisedReading linearise(const PositionDomain& domain, const Calibration& calibration, const Eigen::VectorXd& v) {
    const LogNormalPrior& prior = calibration.prior;
    const Eigen::VectorXd at = prior.mean + prior.coloured(v).col(0);
    const Prediction prediction = domain.predict(at, 1, nullptr, true);
    const ErrorJacobian jacobian = domain.jacobian(at, prediction, 1);
    const Spectrum told = leading_spectrum(whitened_curvature(jacobian, prior), domain.parameters().size(),
                                           {.largest = most_of_a_reading});
    const Eigen::Index k = (told.values.array() > least_told).count();
    LinearisedReading local;
    local.W = told.vectors.leftCols(k);
    const Eigen::VectorXd root = jacobian.weights(0).cwiseSqrt();
    local.B = root.asDiagonal() * jacobian.moved_markers(0, prior.coloured(local.W));
    local.d = root.cwiseProduct(jacobian.errors(0));
    local.squared_error = jacobian.errors(0).squaredNorm();
    const StateReadings& state = domain.states().front();
    const double of_model = Eigen::numext::abs2(calibration.model_error) * domain.squared_scale(0);
    local.variance.setZero(local.d.size());
    for (Eigen::Index i = 0; i < local.d.size(); ++i) {
        const double noise = known_part(state.noise[i / 3]);
        local.variance[i] = jacobian.weights(0)[i] * (Eigen::numext::abs2(noise) + of_model);
    }
    return local;
}

double p_value(const LinearisedReading& local, const Spectrum& A) {
    // d^T (1 + B M B^T)^-1 d with M = W^T (1 + A)^-1 W, the covariance of what the reading tells about
    const Eigen::MatrixXd M = local.W.transpose() * A.inverse(1, local.W);
    const Eigen::VectorXd b = local.B.transpose() * local.d;
    const Eigen::MatrixXd G = local.B.transpose() * local.B;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(M.rows(), M.cols());
    const double explained = M.size() > 0 ? b.dot((one + M * G).partialPivLu().solve(M * b)) : 0;
    const double chi_squared = std::max(0.0, local.d.squaredNorm() - explained), count = local.variance.sum();
    return count > 0 ? boost::math::gamma_q(count / 2, chi_squared / 2) : 1;
}

}  // namespace palpate::identify
