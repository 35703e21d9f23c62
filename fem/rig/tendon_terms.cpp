#include "fem/rig/tendon_terms.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "mesh/errors.h"

namespace palpate::fem {

namespace {

constexpr double over_body = 1e3;  // of the cable's stiffness: what it gives way by is a thousandth

/// The segments of a path.
struct Segments {
    Eigen::VectorXd length;  // (s)
    Points along;            // unit (s x 3)

    explicit Segments(const Points& x) {
        if (x.rows() < 2)
            throw InvalidInput(fmt::format("A tendon's path has {} points; allowed: 2 and more.", x.rows()));
        length.resize(x.rows() - 1);
        along.resize(x.rows() - 1, 3);
        for (Eigen::Index k = 0; k < count(); ++k) {
            const Vec3 way = x.row(k + 1) - x.row(k);
            length[k] = way.norm();
            if (length[k] == 0)
                throw InvalidInput(
                    fmt::format("Points {} and {} of a tendon's path are in one place, ({:g}, {:g}, {:g}) mm: take one "
                                "of them out.",
                                k + 1, k + 2, x(k, 0), x(k, 1), x(k, 2)));
            along.row(k) = way / length[k];
        }
    }

    Eigen::Index count() const { return length.size(); }

    /// d length_k / dx, times a factor, added to `sum` (p x 3).
    void add_gradient(Eigen::Index k, double factor, Points& sum) const {
        sum.row(k) -= factor * along.row(k);
        sum.row(k + 1) += factor * along.row(k);
    }
    /// sum_k factor_k d length_k / dx (p x 3).
    Points gradient(const Eigen::VectorXd& factors) const {
        Points sum = Points::Zero(count() + 1, 3);
        for (Eigen::Index k = 0; k < count(); ++k) add_gradient(k, factors[k], sum);
        return sum;
    }
    /// sum_k factor_k d^2 length_k / dx^2 (3p x 3p).
    Eigen::MatrixXd hessian(const Eigen::VectorXd& factors) const {
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * (count() + 1), 3 * (count() + 1));
        for (Eigen::Index k = 0; k < count(); ++k) {
            const Vec3 t = along.row(k);
            const Mat3 across = factors[k] / length[k] * (Mat3::Identity() - t * t.transpose());
            for (const int i : {0, 1}) {
                for (const int j : {0, 1}) sum.block<3, 3>(3 * (k + i), 3 * (k + j)) += i == j ? across : Mat3(-across);
            }
        }
        return sum;
    }

    /// The angles by which the path has turned up to each segment (s) [rad].
    Eigen::VectorXd turns() const {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(count());
        for (Eigen::Index k = 1; k < count(); ++k) sum[k] = sum[k - 1] + turn(k);
        return sum;
    }
    /// Their derivatives by the points (s x 3p); 0 where the path is straight and turns either way alike.
    Eigen::MatrixXd turns_by_point() const {
        constexpr double straight = 1e-9;  // rounding of the sine
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count(), 3 * (count() + 1));
        for (Eigen::Index k = 1; k < count(); ++k) {
            sum.row(k) = sum.row(k - 1);
            const Vec3 before = along.row(k - 1), after = along.row(k);
            const double sine = before.cross(after).norm(), cosine = before.dot(after);
            if (sine < straight) continue;
            const Vec3 by_before = (cosine * before - after) / (sine * length[k - 1]);
            const Vec3 by_after = (cosine * after - before) / (sine * length[k]);
            sum.row(k).segment<3>(3 * (k - 1)) -= by_before;
            sum.row(k).segment<3>(3 * k) += by_before - by_after;
            sum.row(k).segment<3>(3 * (k + 1)) += by_after;
        }
        return sum;
    }

private:
    double turn(Eigen::Index k) const {
        const Vec3 before = along.row(k - 1), after = along.row(k);
        return std::atan2(before.cross(after).norm(), before.dot(after));
    }
};

/// What a path amounts to for its tendon.
struct PathChange {
    Segments segments;  // whose directions forces follow
    Eigen::VectorXd change;
    double rest_length;

    PathChange(const TendonPull& pull, const Points& x, bool small_strain)
        : segments(small_strain ? pull.actuator->path : x) {
        const Segments rest(pull.actuator->path);
        rest_length = rest.length.sum();
        if (!small_strain) {
            change = segments.length - rest.length;
            return;
        }
        const Points moved = x - pull.actuator->path;
        change.resize(rest.count());
        for (Eigen::Index k = 0; k < rest.count(); ++k)
            change[k] = rest.along.row(k).dot(moved.row(k + 1) - moved.row(k));
    }
};

/// A segment's tension over that at the first point, with what it follows.
struct CapstanShare {
    double share = 1;
    double by_turn = 0;   // d share / d turn [1/rad]
    double by_value = 0;  // d share / d value: where a segment sticks its tension stays
};

CapstanShare capstan_share(const TendonPull& pull, double turn) {
    if (pull.coefficient == 0 || !(pull.value > 0)) return {};
    const double mu = pull.coefficient;
    double tension = 0, sign = -1;
    bool slides = true;
    const auto set_to = [&](double value) {
        const double least = value * std::exp(-mu * turn), most = value * std::exp(mu * turn);
        slides = tension < least || tension > most;
        if (!slides) return;
        sign = tension < least ? -1 : 1;
        tension = tension < least ? least : most;
    };
    for (const double value : pull.earlier) set_to(value);
    set_to(pull.value);
    const double share = tension / pull.value;
    return {share, sign * mu * share, slides ? 0 : -share / pull.value};
}

TendonFriction friction_of(const TendonPull& pull, const PathChange& path) {
    const Eigen::VectorXd turns = path.segments.turns();
    TendonFriction result{Eigen::VectorXd(turns.size()), 0};
    for (Eigen::Index k = 0; k < turns.size(); ++k) result.shares[k] = capstan_share(pull, turns[k]).share;
    if (pull.actuator->by_length) result.taken_up = (1 - result.shares.array()).matrix().dot(path.change);
    return result;
}

double cable_stiffness(const TendonPull& pull, const PathChange& path) {
    return over_body * pull.young * path.rest_length;
}

/// The energy's terms with friction held.
TendonTerms terms_with(const TendonPull& pull, const PathChange& path, const TendonFriction& friction) {
    const bool by_length = pull.actuator->by_length;
    const double k = cable_stiffness(pull, path), counted = friction.shares.dot(path.change);
    const double over = counted + friction.taken_up + pull.value;
    const double tension = by_length ? std::max(0.0, k * over) : pull.value;
    const Eigen::VectorXd all = Eigen::VectorXd::Ones(path.change.size());
    const Points pulled = path.segments.gradient(friction.shares);
    TendonTerms terms{.energy = by_length ? tension * over / 2 : tension * counted,
                      .gradient = tension * pulled,
                      .hessian = {},
                      .state = {.tension = tension, .drawn_in = -path.change.sum()},
                      .lengthening = path.segments.gradient(all),
                      .stiffness = by_length && tension > 0 ? k : 0,
                      .by_value = {}};
    const Eigen::Map<const Eigen::VectorXd> g(pulled.data(), pulled.size());
    terms.hessian = terms.stiffness * g * g.transpose();
    return terms;
}

}  // namespace

TendonPull TendonPull::part(double share) const {
    TendonPull result = *this;
    result.value *= share;
    for (double& value : result.earlier) value *= share;
    if (result.friction) result.friction->taken_up *= share;
    return result;
}

TendonTerms tendon_terms(const TendonPull& pull, const Points& x, bool small_strain) {
    const PathChange path(pull, x, small_strain);
    const TendonFriction friction = pull.friction ? *pull.friction : friction_of(pull, path);
    TendonTerms terms = terms_with(pull, path, friction);
    if (!small_strain) terms.hessian += path.segments.hessian(terms.state.tension * friction.shares);
    Eigen::VectorXd following = (pull.actuator->by_length ? terms.stiffness : 1) * friction.shares;
    const Eigen::VectorXd turns = path.segments.turns();
    for (Eigen::Index k = 0; k < turns.size(); ++k)
        following[k] += terms.state.tension * capstan_share(pull, turns[k]).by_value;
    terms.by_value = path.segments.gradient(following);
    return terms;
}

TendonFriction tendon_friction(const TendonPull& pull, const Points& x, bool small_strain) {
    return friction_of(pull, PathChange(pull, x, small_strain));
}

TendonSliding tendon_sliding(const TendonPull& pull, const Points& x, bool small_strain) {
    const PathChange path(pull, x, small_strain);
    const TendonFriction friction = friction_of(pull, path);
    const TendonTerms terms = terms_with(pull, path, friction);
    const Eigen::Index segments = path.segments.count(), shares = segments - 1, size = 3 * (segments + 1);
    const Eigen::Index count = shares + (pull.actuator->by_length ? 1 : 0);
    const auto flat = [](const Points& points) {
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(points.data(), points.size()));
    };
    TendonSliding result{Eigen::MatrixXd::Zero(size, count), Eigen::MatrixXd::Zero(count, size)};
    const Eigen::VectorXd turns = path.segments.turns(), pulled = flat(path.segments.gradient(friction.shares));
    if (!small_strain) {
        const Eigen::MatrixXd by_point = path.segments.turns_by_point();
        for (Eigen::Index k = 1; k < segments; ++k)
            result.number_by_point.row(k - 1) = capstan_share(pull, turns[k]).by_turn * by_point.row(k);
    }
    for (Eigen::Index k = 1; k < segments; ++k) {
        const Eigen::VectorXd own = flat(path.segments.gradient(Eigen::VectorXd::Unit(segments, k)));
        result.by_number.col(k - 1) = terms.state.tension * own + terms.stiffness * path.change[k] * pulled;
    }
    if (pull.actuator->by_length) {
        result.by_number.col(shares) = terms.stiffness * pulled;
        result.number_by_point.row(shares) =
            flat(path.segments.gradient((1 - friction.shares.array()).matrix())).transpose() -
            path.change.tail(shares).transpose() * result.number_by_point.topRows(shares);
    }
    return result;
}

}  // namespace palpate::fem
