#include "identify/fit/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The start, or if nothing stands there, all stiffnesses threefold until something does.
Prediction first_prediction(const PositionDomain& domain, int threads, Eigen::VectorXd& theta) {
    constexpr int tries = 6;
    for (int i = 0;; ++i) {
        try {
            return domain.predict(theta, threads);
        } catch (const SolverFailure&) {
            if (i == tries) throw;
            theta.array() += std::log(3.0);
        }
    }
}

std::optional<Prediction> try_prediction(const PositionDomain& domain, int threads, const Eigen::VectorXd& theta,
                                         const Prediction& near) {
    try {
        return domain.predict(theta, threads, &near);
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
}

}  // namespace

double LogNormalPrior::half_square(const Eigen::VectorXd& theta) const {
    return 0.5 * (theta - mean).cwiseQuotient(sd).squaredNorm();
}

double LogNormalPrior::log_density(const Eigen::VectorXd& theta) const {
    return -half_square(theta) - (sd.array() * std::sqrt(2 * std::numbers::pi)).log().sum();
}

FitResult fit_map(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start, int threads,
                  const FitOptions& options) {
    FitResult fit;
    fit.theta = start;
    fit.prediction = first_prediction(domain, threads, fit.theta);
    fit.chi_squared = domain.chi_squared(fit.prediction);
    fit.evaluations = 1;
    const Eigen::VectorXd precision = prior.sd.cwiseAbs2().cwiseInverse();

    double damping = 1e-3, growth = 2;
    bool moved = true;
    NormalEquations equations;
    Eigen::VectorXd gradient;
    while (fit.iterations < options.iterations) {
        // Gauss-Newton's quadratic of half of chi^2 and prior
        if (moved) {
            equations = domain.normal_equations(fit.theta, fit.prediction);
            gradient = equations.g + precision.cwiseProduct(fit.theta - prior.mean);
            fit.hessian = equations.H + Eigen::MatrixXd(precision.asDiagonal());
        }
        ++fit.iterations;

        // a damped step, no ratio larger than e
        const Eigen::MatrixXd damped = fit.hessian + Eigen::MatrixXd((damping * fit.hessian.diagonal()).asDiagonal());
        Eigen::VectorXd step = damped.llt().solve(-gradient);
        step /= std::max(1.0, step.cwiseAbs().maxCoeff());
        const double promised = -(gradient.dot(step) + 0.5 * step.dot(fit.hessian * step));
        if (promised < options.tolerance) {
            fit.converged = true;
            break;
        }

        // accept it when half of chi^2 and prior falls
        const Eigen::VectorXd theta = fit.theta + step;
        std::optional<Prediction> trial = try_prediction(domain, threads, theta, fit.prediction);
        ++fit.evaluations;
        double gain = -1, chi_squared = 0;
        if (trial) {
            chi_squared = domain.chi_squared(*trial);
            gain = (0.5 * (fit.chi_squared - chi_squared) + prior.half_square(fit.theta) - prior.half_square(theta)) /
                   promised;
        }
        moved = gain > 0;
        if (moved) {
            fit.theta = theta;
            fit.prediction = std::move(*trial);
            fit.chi_squared = chi_squared;
            damping *= std::max(1.0 / 10, 1 - std::pow(2 * gain - 1, 3));
            growth = 2;
        } else {
            if (damping > 1e12) break;
            damping *= growth;
            growth *= 2;
        }
    }
    if (moved && !fit.converged) {
        equations = domain.normal_equations(fit.theta, fit.prediction);
        fit.hessian = equations.H + Eigen::MatrixXd(precision.asDiagonal());
    }
    return fit;
}

}  // namespace palpate::identify
