#pragma once

#include <array>

#include "skeleton/links/link_energy.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// A link's material as fibres along it. At rest fibre j spans from X_a + r_j to X_b + r_j; its ends are carried
/// rigidly by the spheres, so it stretches in tension and in bending:
///   lambda_j = |x_b + R_b r_j - x_a - R_a r_j| / L.
/// Offsets: two hexagons, turned by 30 degrees against each other, at sqrt((3 +- sqrt 3) / 6) of the radius 2 r_g of
/// the disc that has the radius of gyration r_g; each fibre has the same share of the link's volume. A rule of degree
/// 5, so that second and fourth moments are those of a round section about every axis, and a section that has yielded
/// throughout bears a moment within 3 % of its own, whichever way it is bent.
inline constexpr int fibres_per_link = 12;
inline constexpr double fibre_weight = 1.0 / fibres_per_link;
using FibreOffsets = std::array<Vec3, fibres_per_link>;

/// r_g of the section that a link stands for [mm]: its own, or where it tells none what its stiffnesses amount to.
/// Bent purely by phi its ends turn by +-phi/2, so kF phi^2 / 4 = E I phi^2 / (2 L) and, with kE = E A / L,
///   I / A = kF / (2 kE).
double radius_of_gyration(const Link& link);

/// Outer ones first, the first of them in the plane of the link's flexion. @pre `direction` is the link's unit
/// direction at rest.
FibreOffsets fibre_offsets(const Link& link, const Vec3& direction);

/// Stiffnesses of the fibres, as kE is one, at a link's own k: K = shares k (12 x 3 or 6). In tension and in bending in
/// either plane they come to the link's own, sum_j K_j = kE and sum_j K_j (r_j . f)^2 = kF (kF / 2 of the paper's
/// link), so that where all have yielded hardening's share of the link is left. Where k is that of the section, all are
/// the same; inner ones fall below 0 where the link bends 1.6 times as stiffly as its section stretches.
using FibreShares = Eigen::Matrix<double, fibres_per_link, Eigen::Dynamic, 0, fibres_per_link, 6>;
FibreShares fibre_shares(const Link& link);

/// A function of a stretch, and its derivatives.
struct StretchTerms {
    double energy = 0, first = 0, second = 0;

    StretchTerms& operator+=(const StretchTerms& more) {
        energy += more.energy;
        first += more.first;
        second += more.second;
        return *this;
    }
};

inline StretchTerms operator*(double k, const StretchTerms& terms) {
    return {k * terms.energy, k * terms.first, k * terms.second};
}

/// One fibre as it stands: its stretch, and how that changes with a step of the link's two ends.
class LinkFibre {
public:
    /// @throws SolverFailure when its ends coincide.
    LinkFibre(double length, const Vec3& offset, const Vec3& x_a, const Mat3& R_a, const Vec3& x_b, const Mat3& R_b);

    double stretch() const { return l_ / length_; }
    /// Adds the first derivative of an energy of the stretch.
    void add_gradient(const StretchTerms& terms, Eigen::Ref<Vec12> g) const;
    /// Adds the second, in exponential coordinates.
    void add_hessian(const StretchTerms& terms, Mat12& H) const;

private:
    double length_, l_;   // at rest, now [mm]
    Vec3 arm_a_, arm_b_;  // R r
    Vec3 along_;          // unit, from a to b
};

}  // namespace palpate::skeleton
