#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "fem/large_deformation/material_law.h"
#include "mesh/types.h"

namespace palpate::fem {

/// A law at one point with deformation gradient F: its energy density is
///   W(F) = mu D(F) + K/2 v(F)^2
/// with D the energy of distortion and v the measure of volume change.
///
/// `D`, `v`, `dD` = dD/dF and `dv` = dv/dF; `second(c, d, mu, p)` is the block (a, b) of
/// mu d^2 D / dF_ca dF_db + p d^2 v / dF_ca dF_db.
template <MaterialLaw law>
struct PointLaw;

/// D = (J^-2/3 tr F^T F - 3) / 2, v = J - 1.
template <>
struct PointLaw<MaterialLaw::neo_hookean> {
    Mat3 F, dv;  // dv = dJ/dF = J F^-T
    double J, s, invariant;
    double D, v;
    Mat3 dD;

    explicit PointLaw(const Mat3& gradient) : F(gradient) {
        for (int c = 0; c < 3; ++c) dv.row(c) = F.row((c + 1) % 3).cross(F.row((c + 2) % 3));
        J = F.row(0).dot(dv.row(0));
        const double root = 1 / std::cbrt(J);
        s = root * root;
        invariant = F.squaredNorm();
        D = (s * invariant - 3) / 2;
        v = J - 1;
        dD = s * (F - invariant / (3 * J) * dv);  // dJ^-2/3/dF = -2/3 J^-5/3 dJ/dF
    }
    bool inside_out() const { return !(J > 0); }

    Mat3 second(int c, int d, double mu, double p) const {
        const double cross = -2 * mu * s / (3 * J), twice = 5 * mu * s * invariant / (9 * J * J);
        Mat3 A = (cross * F.row(c) + twice * dv.row(c)).transpose() * dv.row(d);
        A += cross * dv.row(c).transpose() * F.row(d);
        if (c == d) {
            A.diagonal().array() += mu * s;
        } else {
            // d^2 J / dF_ca dF_db = sum_ef epsilon_cde epsilon_abf F_ef
            const int e = 3 - c - d;
            const double factor = (p - mu * s * invariant / (3 * J)) * ((c + 1) % 3 == d ? 1 : -1);
            const Vec3 row = factor * F.row(e);
            A(0, 1) += row(2), A(1, 0) -= row(2);
            A(1, 2) += row(0), A(2, 1) -= row(0);
            A(2, 0) += row(1), A(0, 2) -= row(1);
        }
        return A;
    }
};

/// D = dev(E):dev(E), v = tr E with E = (F^T F - I) / 2.
template <>
struct PointLaw<MaterialLaw::svk> {
    Mat3 F, S;  // S = 2 dev(E)
    double D, v;
    Mat3 dD, dv;

    explicit PointLaw(const Mat3& gradient) : F(gradient) {
        S = F.transpose() * F - Mat3::Identity();
        v = S.trace() / 2;
        S.diagonal().array() -= 2 * v / 3;
        D = S.squaredNorm() / 4;
        dD = F * S;
        dv = F;
    }
    bool inside_out() const { return !(F.determinant() > 0); }

    Mat3 second(int c, int d, double mu, double p) const {
        Mat3 A = mu * (F.row(d).transpose() * F.row(c) - 2.0 / 3 * F.row(c).transpose() * F.row(d));
        A.diagonal().array() += mu * F.row(c).dot(F.row(d)) + (c == d ? p : 0);
        if (c == d) A += mu * S;
        return A;
    }
};

/// D = dev(eps):dev(eps), v = tr eps with eps the symmetric part of F - I.
template <>
struct PointLaw<MaterialLaw::linear> {
    double D, v;
    Mat3 dD, dv = Mat3::Identity();

    explicit PointLaw(const Mat3& F) {
        dD = F + F.transpose() - 2 * Mat3::Identity();  // 2 eps, then less its trace
        v = dD.trace() / 2;
        dD.diagonal().array() -= 2 * v / 3;
        D = dD.squaredNorm() / 4;
    }
    static bool inside_out() { return false; }

    static Mat3 second(int c, int d, double mu, double) {
        Mat3 A = Mat3::Zero();
        A(d, c) += mu;
        A(c, d) -= 2.0 / 3 * mu;
        if (c == d) A.diagonal().array() += mu;
        return A;
    }
};

}  // namespace palpate::fem
