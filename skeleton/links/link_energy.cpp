#include "skeleton/links/link_energy.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

namespace {

// Adds a second derivative by (x_b - x_a) to the four blocks of the two displacements.
void add_stretch_block(const Mat3& B, Mat12& H) {
    H.block<3, 3>(dx_a, dx_a) += B;
    H.block<3, 3>(dx_b, dx_b) += B;
    H.block<3, 3>(dx_a, dx_b) -= B;
    H.block<3, 3>(dx_b, dx_a) -= B;
}

// Elongation e = 1/2 (l - L)^2: by dx its gradient is (l - L) n, and as dn = (I - n n^T) d(dx) / l, its second
// derivative n n^T + (1 - L / l) (I - n n^T).
class Elongation {
public:
    Elongation(const LinkAxis& axis, double length) : axis_(axis), stretch_(axis.l - length) {}

    double energy() const { return 0.5 * stretch_ * stretch_; }

    void gradient(Eigen::Ref<Vec12> g) const {
        g.segment<3>(dx_a) = -stretch_ * axis_.n;
        g.segment<3>(dx_b) = stretch_ * axis_.n;
    }

    void add_hessian(double k, Mat12& H) const {
        const double across = stretch_ / axis_.l;
        Mat3 B = (k * (1 - across)) * axis_.n * axis_.n.transpose();
        B.diagonal().array() += k * across;
        add_stretch_block(B, H);
    }

private:
    const LinkAxis& axis_;
    double stretch_;
};

// Flexion at one end, which carries the direction d: e = 1/2 theta^2 = phi(c), c = n . d = cos theta. In c all is
// smooth at theta = 0:
//   phi'  = -theta / sin theta
//   phi'' = (sin theta - theta cos theta) / sin^3 theta = 1/3 + 2/15 theta^2 + 2/63 theta^4 + ...
// With d -> d + w x d + 1/2 w x (w x d), q = d - c n and P = I - n n^T the derivatives of c are
//   by dx: q / l              by w: d x n
//   by dx, dx: -(q n^T + n q^T + c P) / l^2
//   by w, w:   1/2 (n d^T + d n^T) - c I
//   by w, dx:  [d] P / l
// and those of e: phi' c_i, phi'' c_i c_j + phi' c_ij.
class Flexion {
public:
    Flexion(const LinkAxis& axis, const Vec3& d, int w) : axis_(axis), d_(d), w_(w), c_(axis.n.dot(d)) {
        turn_ = d.cross(axis.n);
        const double sine = turn_.norm();
        theta_ = std::atan2(sine, c_);
        // At theta = pi the energy has a tip: there the slope is that of a point beside it.
        slope_ = c_ > 0 && sine < 1e-9 ? -1.0 : -theta_ / std::max(sine, 1e-9);
    }

    double energy() const { return 0.5 * theta_ * theta_; }

    void add_gradient(Eigen::Ref<Vec12> g) const {
        const Vec3 by_dx = (slope_ / axis_.l) * (d_ - c_ * axis_.n);
        g.segment<3>(dx_a) -= by_dx;
        g.segment<3>(dx_b) += by_dx;
        g.segment<3>(w_) += slope_ * turn_;
    }

    void add_hessian(double k, Mat12& H) const {
        const Vec3& n = axis_.n;
        const Vec3 q = (d_ - c_ * n) / axis_.l;
        const double first = k * slope_, second = k * curvature();

        // by dx, dx
        const Mat3 qn = q * n.transpose() / axis_.l;
        Mat3 B = second * q * q.transpose() - first * (qn + qn.transpose());
        const double across = first * c_ / (axis_.l * axis_.l);
        B += across * n * n.transpose();
        B.diagonal().array() -= across;
        add_stretch_block(B, H);

        // by w, w
        const Mat3 nd = (0.5 * first) * n * d_.transpose();
        Mat3 W = second * turn_ * turn_.transpose() + nd + nd.transpose();
        W.diagonal().array() -= first * c_;
        H.block<3, 3>(w_, w_) += W;

        // by w, dx: [d] P = [d] - (d x n) n^T
        const Mat3 M = second * turn_ * q.transpose() + (first / axis_.l) * (skew(d_) - turn_ * n.transpose());
        H.block<3, 3>(w_, dx_b) += M;
        H.block<3, 3>(w_, dx_a) -= M;
        H.block<3, 3>(dx_b, w_) += M.transpose();
        H.block<3, 3>(dx_a, w_) -= M.transpose();
    }

private:
    double curvature() const {
        if (c_ > 0 && theta_ < 0.02) {
            const double square = theta_ * theta_;
            return 1.0 / 3 + square * (2.0 / 15 + square * (2.0 / 63));
        }
        const double sine = std::max(turn_.norm(), 1e-9);
        return (sine - theta_ * c_) / (sine * sine * sine);
    }

    const LinkAxis& axis_;
    const Vec3& d_;  // R d0
    int w_;          // place of the end's rotation in the step
    double c_;
    Vec3 turn_;  // d x n
    double theta_, slope_;
};

// Torsion e = 1/2 tau^2, tau = 2 atan2(s, w) with (w, v) the unit quaternion of Q = R_a^T R_b and s = v . d0. Turned
// to space by R_a, (w, v) is the quaternion p of R_b R_a^T and s = v . d, d = R_a d0. A step takes p to g p,
//   g = exp(-w_a/2) exp(w_b/2) = (1 - |m|^2 / 8, m / 2 - w_a x w_b / 4) + O(3),  m = w_b - w_a,
// so with y = w d + v x d
//   dw = -m . v / 2 - |m|^2 w / 8 + (w_a x w_b) . v / 4
//   ds =  m . y / 2 - |m|^2 s / 8 - (w_a x w_b) . y / 4.
// Into tau: tau_s = 2 w / rho, tau_w = -2 s / rho, rho = s^2 + w^2. The terms in |m|^2 cancel, and what is left is
//   dtau = m . h + (m . h) (m . j) / 2 - (w_a x w_b) . h / 2,   h = (w y + s v) / rho,   j = (w v - s y) / rho.
class Torsion {
public:
    Torsion(const Vec3& d, const Mat3& R_a, const Mat3& R_b) {
        Eigen::Quaterniond p(Mat3(R_b * R_a.transpose()));
        if (p.w() < 0) p.coeffs() = -p.coeffs();
        const double w = p.w();
        const Vec3 v = p.vec();
        const double s = v.dot(d);
        const double rho = std::max(s * s + w * w, 1e-24);  // 0 where the ends point against one another
        const Vec3 y = w * d + v.cross(d);
        tau_ = 2 * std::atan2(s, w);
        h_ = (w * y + s * v) / rho;
        j_ = (w * v - s * y) / rho;
    }

    double energy() const { return 0.5 * tau_ * tau_; }

    void gradient(Eigen::Ref<Vec12> g) const {
        g.segment<3>(w_a) = -tau_ * h_;
        g.segment<3>(w_b) = tau_ * h_;
    }

    void add_hessian(double k, Mat12& H) const {
        const Mat3 hj = (0.5 * k * tau_) * h_ * j_.transpose();
        const Mat3 T = k * h_ * h_.transpose() + hj + hj.transpose();
        const Mat3 S = skew((0.5 * k * tau_) * h_);  // of -(w_a x w_b) . h / 2
        H.block<3, 3>(w_a, w_a) += T;
        H.block<3, 3>(w_b, w_b) += T;
        H.block<3, 3>(w_a, w_b) += S - T;
        H.block<3, 3>(w_b, w_a) -= S + T;
    }

private:
    double tau_;
    Vec3 h_, j_;
};

}  // namespace

LinkAxis link_axis(double length, const Vec3& x_a, const Vec3& x_b) {
    const Vec3 dx = x_b - x_a;
    const double l = dx.norm();
    if (!(l > 1e-9 * length))
        throw SolverFailure(
            fmt::format("the ends of a link of rest length {:.6g} mm came to lie on one another; "
                        "a smaller load or a stiffer link would keep them apart",
                        length));
    return {l, dx / l};
}

LinkTerms link_terms(double length, const Vec3& rest_direction, const Vec3& x_a, const Mat3& R_a, const Vec3& x_b,
                     const Mat3& R_b, bool with_hessian) {
    const LinkAxis link = link_axis(length, x_a, x_b);
    const Vec3 d_a = R_a * rest_direction, d_b = R_b * rest_direction;
    const Elongation elongation(link, length);
    const Flexion flexion_a(link, d_a, w_a), flexion_b(link, d_b, w_b);
    const Torsion torsion(d_a, R_a, R_b);

    LinkTerms terms;
    terms.energy = Vec3(elongation.energy(), flexion_a.energy() + flexion_b.energy(), torsion.energy());
    terms.gradient.setZero(12, 3);
    elongation.gradient(terms.gradient.col(0));
    flexion_a.add_gradient(terms.gradient.col(1));
    flexion_b.add_gradient(terms.gradient.col(1));
    torsion.gradient(terms.gradient.col(2));
    if (with_hessian) {
        for (int s = 0; s < 3; ++s) terms.hessian[s].setZero();
        elongation.add_hessian(1, terms.hessian[0]);
        flexion_a.add_hessian(1, terms.hessian[1]);
        flexion_b.add_hessian(1, terms.hessian[1]);
        torsion.add_hessian(1, terms.hessian[2]);
    }
    return terms;
}

Mat12 link_hessian(const Vec3& stiffness, double length, const Vec3& rest_direction, const Vec3& x_a, const Mat3& R_a,
                   const Vec3& x_b, const Mat3& R_b) {
    const LinkAxis link = link_axis(length, x_a, x_b);
    const Vec3 d_a = R_a * rest_direction, d_b = R_b * rest_direction;
    Mat12 H = Mat12::Zero();
    Elongation(link, length).add_hessian(stiffness[0], H);
    Flexion(link, d_a, w_a).add_hessian(stiffness[1], H);
    Flexion(link, d_b, w_b).add_hessian(stiffness[1], H);
    Torsion(d_a, R_a, R_b).add_hessian(stiffness[2], H);
    return H;
}

}  // namespace palpate::skeleton
