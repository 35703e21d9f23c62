#pragma once

#include <cmath>
#include <numbers>

#include "identify/inference/particles/hamiltonian/density_with_gradient.h"
#include "identify/inference/particles/proposal.h"

namespace palpate::identify {

/// Numbers that are each read as a displacement goes with stiffness, y = exp(-theta) + noise, under a prior
/// N(0, 0.7^2): skewed, and the exact posterior of each is an integral over a line.
struct NonlinearReadings {
    static constexpr double prior_sd = 0.7;
    Eigen::VectorXd y, sigma;

    double half_square(double t, Eigen::Index i) const {
        const double error = (y[i] - std::exp(-t)) / sigma[i];
        return error * error / 2 + t * t / (2 * prior_sd * prior_sd);
    }
    double gradient(double t, Eigen::Index i) const {
        return (y[i] - std::exp(-t)) * std::exp(-t) / (sigma[i] * sigma[i]) + t / (prior_sd * prior_sd);
    }
    double constant(Eigen::Index i) const { return -std::log(2 * std::numbers::pi * sigma[i] * prior_sd); }

    DensityWithGradient density() const {
        return [this](const Eigen::VectorXd& theta, Eigen::VectorXd& by_theta) {
            double sum = 0;
            for (Eigen::Index i = 0; i < theta.size(); ++i) {
                sum += constant(i) - half_square(theta[i], i);
                by_theta[i] = -gradient(theta[i], i);
            }
            return sum;
        };
    }

    struct Exact {
        double mean = 0, sd = 0, log_evidence = 0, mode = 0;
    };
    Exact exact(Eigen::Index i) const {
        constexpr double low = -4, high = 4, h = 1e-3;
        double z = 0, first = 0, second = 0, best = 1e300;
        Exact result;
        for (double t = low; t <= high; t += h) {
            const double half = half_square(t, i), weight = std::exp(-half);
            z += weight;
            first += weight * t;
            second += weight * t * t;
            if (half < best) {
                best = half;
                result.mode = t;
            }
        }
        result.mean = first / z;
        result.sd = std::sqrt(second / z - result.mean * result.mean);
        result.log_evidence = std::log(z * h) + constant(i);
        return result;
    }

    /// Laplace's approximation at the mode.
    GaussianProposal proposal() const {
        const Eigen::Index P = y.size();
        GaussianProposal q{Eigen::VectorXd(P), {}, {}, 1};
        q.prior = {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, prior_sd), nullptr};
        q.spectrum = {Eigen::VectorXd(P), Eigen::MatrixXd::Identity(P, P)};
        for (Eigen::Index i = 0; i < P; ++i) {
            q.mean[i] = exact(i).mode;
            const double root = prior_sd * std::exp(-q.mean[i]) / sigma[i];
            q.spectrum.values[i] = root * root;
        }
        return q;
    }
};

}  // namespace palpate::identify
