#pragma once

#include <vector>

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// Stiffness that varies smoothly over the body, as a log-normal field: a Gaussian process made of kernels round places
/// that are spread over the body [Higdon 1998],
///   s(X) = exp(f(X) - mean of f over the places),   f(X) = sum_i a_i k_i(X) / sqrt(sum_j k_j(X)^2),
///   k_i(X) = exp(-|X - X_i|^2 / (2 length^2)).
/// With independent a_i of one variance f has that variance everywhere, whatever the length.
class StiffnessMap : public MaterialEffect {
public:
    /// @param places of the kernels (n x 3) [mm], n > 0
    /// @param amplitudes a (n) [-]
    /// @param length of the kernels [mm] > 0
    StiffnessMap(Points places, Eigen::VectorXd amplitudes, double length);

    double stiffness(const Vec3& X) const override { return std::exp(log_stiffness(X)); }
    bool is_scale() const override { return true; }

    double log_stiffness(const Vec3& X) const { return weights(X).dot(amplitudes_) - mean_; }
    /// d f(X) / d a (n).
    Eigen::VectorXd weights(const Vec3& X) const;
    /// d log_stiffness(X) / d a (n).
    Eigen::VectorXd centred_weights(const Vec3& X) const { return weights(X) - mean_weights_; }

    const Points& places() const { return places_; }
    double length() const { return length_; }

private:
    Points places_;
    Eigen::VectorXd amplitudes_, mean_weights_;
    double length_, mean_ = 0;
};

/// Places that a map has at most: a name and four numbers of each are told.
inline constexpr int most_places = 40;

/// The numbers of a map: its length, and x, y, z and a of each place, numbered from 1.
StiffnessMap stiffness_map(const EffectNumbers& numbers);

/// How files and users tell it.
KnownEffect known_stiffness_map();

}  // namespace palpate::fem
