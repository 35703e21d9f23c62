#include "fem/rig/tendon_terms.h"

#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"

namespace palpate::fem {

namespace {

constexpr double over_body = 1e3;  // of the cable's stiffness: what it gives way by is a thousandth

/// The length and its derivatives.
struct PathLength {
    double value = 0;
    Points gradient;
    Eigen::MatrixXd hessian;

    explicit PathLength(const Points& x)
        : gradient(Points::Zero(x.rows(), 3)), hessian(Eigen::MatrixXd::Zero(3 * x.rows(), 3 * x.rows())) {
        if (x.rows() < 2)
            throw InvalidInput(fmt::format("A tendon's path has {} points; allowed: 2 and more.", x.rows()));
        for (Eigen::Index k = 0; k + 1 < x.rows(); ++k) {
            const Vec3 way = x.row(k + 1) - x.row(k);
            const double length = way.norm();
            if (length == 0)
                throw InvalidInput(
                    fmt::format("Points {} and {} of a tendon's path are in one place, ({:g}, {:g}, {:g}) mm: take one "
                                "of them out.",
                                k + 1, k + 2, x(k, 0), x(k, 1), x(k, 2)));
            const Vec3 t = way / length;
            value += length;
            gradient.row(k) -= t;
            gradient.row(k + 1) += t;
            const Mat3 across = (Mat3::Identity() - t * t.transpose()) / length;
            for (const int i : {0, 1}) {
                for (const int j : {0, 1})
                    hessian.block<3, 3>(3 * (k + i), 3 * (k + j)) += i == j ? across : Mat3(-across);
            }
        }
    }
};

}  // namespace

TendonTerms tendon_terms(const TendonPull& pull, const Points& x, bool small_strain) {
    const auto& [path, by_length] = *pull.actuator;
    const PathLength rest(path);
    PathLength now = small_strain ? rest : PathLength(x);
    if (small_strain) {
        now.value += now.gradient.cwiseProduct(x - path).sum();
        now.hessian.setZero();
    }
    const double change = now.value - rest.value, k = over_body * pull.young * rest.value;
    const double over = change + pull.value;
    const double tension = !by_length ? pull.value : std::max(0.0, k * over);
    TendonTerms terms{.energy = by_length ? tension * over / 2 : tension * change,
                      .gradient = tension * now.gradient,
                      .hessian = tension * now.hessian,
                      .state = {.tension = tension, .drawn_in = -change},
                      .lengthening = now.gradient,
                      .stiffness = by_length && tension > 0 ? k : 0};
    const Eigen::Map<const Eigen::VectorXd> g(now.gradient.data(), now.gradient.size());
    terms.hessian += terms.stiffness * g * g.transpose();
    return terms;
}

}  // namespace palpate::fem
