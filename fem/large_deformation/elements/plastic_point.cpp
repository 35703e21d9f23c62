#include "fem/large_deformation/elements/plastic_point.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "fem/large_deformation/elements/point_law.h"

namespace palpate::fem {

namespace {

using Second = MaterialTerms::Second;

constexpr double tiny = 1e-300;  // for directions of what is zero

/// Rows first, as MaterialTerms counts.
Eigen::Matrix<double, 9, 1> flat(const Mat3& A) { return A.reshaped<Eigen::RowMajor>(); }

/// Sets the blocks (c, d) of a second derivative.
template <class Block>
Second blocks(Block&& block) {
    Second result;
    for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
            result.block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * d) = block(c, d);
        }
    }
    return result;
}

/// An elastic step from what was before; stresses are shares of the shear modulus. Neo-Hooke's law takes
/// Fe = F L and be = J^-2/3 Fe Fe^T, the others their strain less the plastic one.
struct Trial {
    double D;         // energy of distortion
    Mat3 dD;          // dD/dF
    Mat3 stress;      // deviatoric: dev be, or the second Piola-Kirchhoff stress
    double a;         // its norm
    Mat3 da;          // da/dF
    double mean = 1;  // tr be / 3
    Mat3 dmean = Mat3::Zero();
};

template <MaterialLaw law>
struct Elastic;

template <>
struct Elastic<MaterialLaw::neo_hookean> {
    Mat3 L;
    PointLaw<MaterialLaw::neo_hookean> law;

    Elastic(const PlasticPoint& before, const Mat3& F) : L(Mat3::Identity() + before.set), law(F * L) {}

    Trial trial() const {
        const Mat3 be = law.s * law.F * law.F.transpose();
        Trial result;
        result.D = law.D;
        result.mean = be.trace() / 3;
        result.stress = be - result.mean * Mat3::Identity();
        result.a = result.stress.norm();
        // By Fe, then by F: dFe/dF = L. D = (3 mean - 3) / 2; a^2 = be:be - 3 mean^2.
        const Mat3 dmean = 2.0 / 3 * law.dD;
        const Mat3 half = law.s * be * law.F - be.squaredNorm() / (3 * law.J) * law.dv - 1.5 * result.mean * dmean;
        result.dD = law.dD * L.transpose();
        result.dmean = dmean * L.transpose();
        result.da = 2 / std::max(result.a, tiny) * half * L.transpose();
        return result;
    }
    Mat3 second(int c, int d) const { return L * law.second(c, d, 1, 0) * L.transpose(); }
};

/// Strain less the plastic one: dE is the symmetric part of M^T dF.
Trial additive(const PlasticPoint& before, const Mat3& stress, const Mat3& M) {
    Trial result;
    result.stress = stress - 2 * before.set;
    result.a = result.stress.norm();
    result.D = result.stress.squaredNorm() / 4;
    result.dD = M * result.stress;
    result.da = 2 / std::max(result.a, tiny) * result.dD;
    return result;
}

template <>
struct Elastic<MaterialLaw::svk> {
    const PlasticPoint& before;
    PointLaw<MaterialLaw::svk> law;

    Elastic(const PlasticPoint& was, const Mat3& F) : before(was), law(F) {}
    Trial trial() const { return additive(before, law.S, law.F); }
    Mat3 second(int c, int d) const { return law.second(c, d, 1, 0) - (c == d ? 2 : 0) * before.set; }
};

template <>
struct Elastic<MaterialLaw::linear> {
    const PlasticPoint& before;
    PointLaw<MaterialLaw::linear> law;

    Elastic(const PlasticPoint& was, const Mat3& F) : before(was), law(F) {}
    Trial trial() const { return additive(before, law.dD, Mat3::Identity()); }
    Mat3 second(int c, int d) const { return law.second(c, d, 1, 0); }
};

/// By how much the trial stress passes the yield surface, which is at |dev stress| = sqrt(2/3) times Mises'.
double excess(const Trial& trial, const Plasticity& plasticity, double alpha) {
    const double radius = std::sqrt(2.0 / 3) * 3 * (plasticity.yield + plasticity.hardening * alpha);
    return trial.a - radius;
}

template <MaterialLaw law>
MaterialTerms terms_of(const Plasticity& plasticity, const PlasticPoint& before, const Mat3& F, bool flows,
                       bool with_second) {
    const Elastic<law> step(before, F);
    const Trial elastic = step.trial();
    const double over = flows ? excess(elastic, plasticity, before.alpha) : 0;
    if (over <= 0 && before.set.isZero(0)) return {};

    // The stress returns to phi times itself; Box 9.1 with h = hardening / (3 mu).
    const double h = plasticity.hardening, a = elastic.a, mean = elastic.mean;
    const double share = over > 0 ? over / a : 0, returned = mean / (mean + h), phi = 1 - share * returned;

    const PointLaw<law> own(F);
    MaterialTerms result;
    // int (1 - R / a) dD with the norm of the stress a = 2 sqrt(D), as in small strain; R = a - over.
    const double past = over > 0 ? std::sqrt(elastic.D) - (a - over) / 2 : 0;
    result.w = elastic.D - returned * past * past - own.D;
    result.first = phi * elastic.dD - own.dD;
    if (!with_second) return result;
    result.second = blocks([&](int c, int d) -> Mat3 { return phi * step.second(c, d) - own.second(c, d, 1, 0); });
    if (over > 0) {
        const Mat3 dphi =
            -(1 - share) / a * returned * elastic.da - share * h / ((mean + h) * (mean + h)) * elastic.dmean;
        const Second turned = flat(elastic.dD) * flat(dphi).transpose();
        result.second += (turned + turned.transpose()) / 2;
    }
    return result;
}

/// Unimodular be with a given deviator s: x in det(s + x I) = x^3 - s:s/2 x + det s = 1, by Newton's method from above.
double mean_of(const Mat3& s) {
    const double b = s.squaredNorm() / 2, c = s.determinant() - 1;
    double x = std::cbrt(1 + std::abs(s.determinant())) + s.norm();
    for (int k = 0; k < 50; ++k) {
        const double step = (x * (x * x - b) + c) / (3 * x * x - b);
        x -= step;
        if (std::abs(step) < 1e-15 * x) break;
    }
    return x;
}

template <MaterialLaw law>
PlasticPoint after(const Plasticity& plasticity, const PlasticPoint& before, const Mat3& F) {
    const Trial elastic = Elastic<law>(before, F).trial();
    const double over = excess(elastic, plasticity, before.alpha);
    if (over <= 0) return before;

    const double gamma = over / (2 * (elastic.mean + plasticity.hardening));
    PlasticPoint result = before;
    result.alpha += std::sqrt(2.0 / 3) * gamma;
    if constexpr (law == MaterialLaw::neo_hookean) {
        const double phi = 1 - 2 * elastic.mean * gamma / elastic.a;
        const Mat3 s = phi * elastic.stress, be = s + mean_of(s) * Mat3::Identity();
        const Mat3 inverse = F.inverse() * std::cbrt(F.determinant());
        const Mat3 inverse_cp = inverse * be * inverse.transpose();
        result.set = Mat3(inverse_cp.llt().matrixL()) - Mat3::Identity();
    } else {
        result.set += gamma / elastic.a * elastic.stress;
    }
    return result;
}

}  // namespace

MaterialTerms plastic_terms(MaterialLaw law, const Plasticity& plasticity, const PlasticPoint& before, const Mat3& F,
                            bool flows, bool with_second) {
    switch (law) {
        case MaterialLaw::linear:
            return terms_of<MaterialLaw::linear>(plasticity, before, F, flows, with_second);
        case MaterialLaw::svk:
            return terms_of<MaterialLaw::svk>(plasticity, before, F, flows, with_second);
        default:
            return terms_of<MaterialLaw::neo_hookean>(plasticity, before, F, flows, with_second);
    }
}

PlasticPoint plastic_point(MaterialLaw law, const Plasticity& plasticity, const PlasticPoint& before, const Mat3& F) {
    switch (law) {
        case MaterialLaw::linear:
            return after<MaterialLaw::linear>(plasticity, before, F);
        case MaterialLaw::svk:
            return after<MaterialLaw::svk>(plasticity, before, F);
        default:
            return after<MaterialLaw::neo_hookean>(plasticity, before, F);
    }
}

}  // namespace palpate::fem
