#pragma once

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <numbers>

namespace palpate::fem {

/// A rigid indenter on an elastic layer of thickness h that is bonded to a rigid base, without friction, in small
/// strain. [Hayes et al. 1972; Lebedev & Ufliand 1958] With phi on [0, a],
///   phi(t) + 2/pi int_0^a phi(s) int_0^inf (L(k h) - 1) cos(k t) cos(k s) dk ds = b(t),
///   F = 2 E / (1 - nu^2) int_0^a phi dt,
/// b = d under a flat punch at depth d, b = d - t^2/R under a sphere, whose contact ends where phi(a) = 0. Thick
/// layers, L = 1, make F = 2 E d a / (1 - nu^2) [Boussinesq-Sneddon] and 4/3 E / (1 - nu^2) sqrt(R d^3) [Hertz].
struct LayerContact {
    double h, E, nu;

    /// How the surface of the layer gives way to a pressure of the wave number x / h, over a half-space's.
    double compliance(double x) const {
        if (x > 20) return 1;
        const double c = 3 - 4 * nu, sh = std::sinh(x), ch = std::cosh(x);
        return (c * sh * ch - x) / (x * x + 4 * (1 - nu) * (1 - nu) + c * sh * sh);
    }

    /// phi at the midpoints of n intervals.
    Eigen::VectorXd phi(double a, const std::function<double(double)>& b) const {
        constexpr int n = 60, waves = 800;
        const double dt = a / n, dk = 20 / h / waves;
        Eigen::MatrixXd C(n, waves);  // cos(k t)
        Eigen::VectorXd weights(waves), right(n);
        for (int j = 0; j < waves; ++j) {
            const double k = (j + 0.5) * dk;
            weights[j] = (compliance(k * h) - 1) * dk;
            for (int i = 0; i < n; ++i) C(i, j) = std::cos(k * (i + 0.5) * dt);
        }
        for (int i = 0; i < n; ++i) right[i] = b((i + 0.5) * dt);
        const Eigen::MatrixXd K = 2 / std::numbers::pi * dt * C * weights.asDiagonal() * C.transpose();
        return (Eigen::MatrixXd::Identity(n, n) + K).lu().solve(right);
    }
    double force_of(const Eigen::VectorXd& phi, double a) const { return 2 * E / (1 - nu * nu) * phi.mean() * a; }

    double flat_punch(double a, double d) const {
        return force_of(phi(a, [&](double) { return d; }), a);
    }
    double sphere(double R, double d) const {
        const auto b = [&](double t) { return d - t * t / R; };
        double low = 0, high = 2 * std::sqrt(R * d);
        for (int k = 0; k < 40; ++k) {
            const double a = (low + high) / 2;
            const Eigen::VectorXd p = phi(a, b);
            const double end = 1.5 * p(p.size() - 1) - 0.5 * p(p.size() - 2);
            (end > 0 ? low : high) = a;
        }
        return force_of(phi(low, b), low);
    }
};

}  // namespace palpate::fem
