#include "identify/fit/fit.h"

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

constexpr double forcing = 1e-3;     // of a step's equations, that may be left of the gradient
constexpr int stale = 12;            // products, after which the spectrum is found anew
constexpr int halvings = 20;         // of a step
constexpr double enough_fall = 1e-4; // of what the slope promises [Armijo]

struct Step {
    Eigen::VectorXd dv;
    double promised;  // fall of half of chi^2 and prior
    int products;
};

/// (1 + A) dv = -g by conjugate gradients, preconditioned by the spectrum of an A nearby.
Step gauss_newton_step(const SymmetricProduct& A, const Eigen::VectorXd& g, const Spectrum& near) {
    Step step{Eigen::VectorXd::Zero(g.size()), 0, 0};
    Eigen::VectorXd r = -g, z = near.inverse_of_one_more(r), p = z;
    double rz = r.dot(z);
    while (step.products < g.size() && r.norm() > forcing * g.norm()) {
        const Eigen::VectorXd q = A(p) + p;
        ++step.products;
        const double length = rz / p.dot(q);
        step.dv += length * p;
        step.promised += length * rz / 2;
        r -= length * q;
        z = near.inverse_of_one_more(r);
        const double rz_next = r.dot(z);
        p = z + rz_next / rz * p;
        rz = rz_next;
    }
    return step;
}

}  // namespace

double LogNormalPrior::half_square(const Eigen::VectorXd& theta) const {
    return 0.5 * (theta - mean).cwiseQuotient(sd).squaredNorm();
}

double LogNormalPrior::log_density(const Eigen::VectorXd& theta) const {
    return -half_square(theta) - (sd.array() * std::sqrt(2 * std::numbers::pi)).log().sum();
}

SymmetricProduct whitened_curvature(const Slopes& slopes, const LogNormalPrior& prior) {
    return [&](const Eigen::MatrixXd& V) { return prior.coloured(slopes.curvature_times(prior.coloured(V))); };
}

FitResult fit_map(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start, int threads,
                  const FitOptions& options) {
    FitResult fit;
    fit.theta = start;
    fit.prediction = first_prediction(domain, threads, fit.theta);
    fit.chi_squared = domain.chi_squared(fit.prediction);
    fit.evaluations = 1;

    std::optional<Slopes> slopes;
    int products = stale + 1;  // of the last step
    while (fit.iterations < options.iterations) {
        // Gauss-Newton's quadratic of half of chi^2 and prior, and the step to its least
        slopes.reset();  // its solvers serve again
        slopes.emplace(domain.slopes(fit.theta, fit.prediction));
        const SymmetricProduct A = whitened_curvature(*slopes, prior);
        const Eigen::VectorXd v = (fit.theta - prior.mean).cwiseQuotient(prior.sd);
        const Eigen::VectorXd g = prior.coloured(slopes->gradient()) + v;
        if (products > stale) fit.spectrum = leading_spectrum(A, domain.parameters().size(), {}, fit.spectrum.vectors);
        const Step step = gauss_newton_step(A, g, fit.spectrum);
        products = step.products;
        ++fit.iterations;
        if (step.promised < options.tolerance) {
            fit.converged = true;
            break;
        }

        // as far along it as half of chi^2 and prior falls
        const Eigen::VectorXd whole = prior.coloured(step.dv);
        double share = 1 / std::max(1.0, whole.cwiseAbs().maxCoeff());
        bool moved = false;
        for (int halving = 0; halving < halvings && !moved; ++halving, share /= 2) {
            const Eigen::VectorXd theta = fit.theta + share * whole;
            std::optional<Prediction> trial = try_prediction(domain, threads, theta, fit.prediction);
            ++fit.evaluations;
            if (!trial) continue;
            const double chi_squared = domain.chi_squared(*trial);
            const double fall =
                (fit.chi_squared - chi_squared) / 2 + prior.half_square(fit.theta) - prior.half_square(theta);
            moved = fall > enough_fall * share * step.promised;
            if (!moved) continue;
            fit.theta = theta;
            fit.prediction = std::move(*trial);
            fit.chi_squared = chi_squared;
        }
        if (!moved) break;
    }

    // what is known there
    if (!fit.converged) {
        slopes.reset();
        slopes.emplace(domain.slopes(fit.theta, fit.prediction));
    }
    fit.spectrum = leading_spectrum(whitened_curvature(*slopes, prior), domain.parameters().size(), {},
                                    fit.spectrum.vectors);
    return fit;
}

}  // namespace palpate::identify
