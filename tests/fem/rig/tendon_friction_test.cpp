// Friction of tendons by the turn.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/rig/tendon_terms.h"

namespace palpate::fem {
namespace {

constexpr double mu = 0.3;

/// A path that turns by an angle at each point between its ends.
Points arc(double turn, int points) {
    Points path(points, 3);
    path.row(0).setZero();
    for (int k = 1; k < points; ++k) {
        const double angle = turn * (k - 1);
        path.row(k) = path.row(k - 1) + Eigen::RowVector3d(10 * std::cos(angle), 10 * std::sin(angle), 0);
    }
    return path;
}

TendonPull pull_along(const Points& path, double value, std::vector<double> earlier = {}, bool by_length = false) {
    return {std::make_shared<mesh::TendonActuator>(mesh::TendonActuator{path, by_length}), value, 0.3, mu,
            std::move(earlier)};
}

/// Tension behind the first of two such turns.
double tension_behind(double turn, double value, std::vector<double> earlier = {}) {
    const Points path = arc(turn, 4);
    return value * tendon_friction(pull_along(path, value, std::move(earlier)), path, false).shares[1];
}

constexpr double rounding = 1e-13;

TEST(TendonFriction, LeavesAShareByTheTurn) {
    const double turn = 0.7;
    const auto shares = [](double angle, double value) {
        return tendon_friction(pull_along(arc(angle, 4), value), arc(angle, 4), false).shares;
    };
    const Eigen::Vector3d expected(1, std::exp(-mu * turn), std::exp(-2 * mu * turn));
    EXPECT_LT((shares(turn, 2) - expected).norm(), rounding);
    EXPECT_EQ(shares(0, 2), Eigen::Vector3d::Ones());
    EXPECT_EQ(shares(turn, 0), Eigen::Vector3d::Ones());  // it hangs loose
}

TEST(TendonFriction, SticksBeforeItSlidesBack) {
    // Drawn in to 2 N and let back: what is behind the turn keeps its tension, and has more than what is before it from
    // 2 exp(-2 mu a) on.
    const double turn = 0.7, fall = std::exp(-mu * turn);
    EXPECT_NEAR(tension_behind(turn, 1.9, {2}), 2 * fall, rounding);
    EXPECT_NEAR(tension_behind(turn, 1, {2}), 1 / fall, rounding);
    // From there it must be drawn in anew, past all that sticks, before that feels it.
    EXPECT_NEAR(tension_behind(turn, 1.2, {2, 1}), 1 / fall, rounding);
    EXPECT_NEAR(tension_behind(turn, 1.9, {2, 1}), 1.9 * fall, rounding);
    // Let go, it forgets.
    EXPECT_NEAR(tension_behind(turn, 1, {2, 0}), fall, rounding);
}

TEST(TendonFriction, PullsAtATurnAsACapstanDoes) {
    const Points path = arc(std::numbers::pi / 2, 3);
    const Points force = -tendon_terms(pull_along(path, 2), path, false).gradient;
    const double behind = 2 * std::exp(-mu * std::numbers::pi / 2);
    EXPECT_LT((force.row(1) - Eigen::RowVector3d(-2, behind, 0)).norm(), rounding);
    EXPECT_LT((force.row(2) - Eigen::RowVector3d(0, -behind, 0)).norm(), rounding);
}

TEST(TendonFriction, LeavesACableUnderWhatItIsLongerThanDrawnIn) {
    Points x = arc(0.5, 4);
    const TendonPull pull = pull_along(x, 1, {}, true);
    const auto length_of = [](const Points& path) {
        double sum = 0;
        for (Eigen::Index k = 0; k + 1 < path.rows(); ++k) sum += (path.row(k + 1) - path.row(k)).norm();
        return sum;
    };
    const double rest = length_of(x);
    x.row(3) -= Eigen::RowVector3d(0.3, 0, 0);
    x.row(2) += Eigen::RowVector3d(0, 0.1, 0.05);
    const TendonState state = tendon_terms(pull, x, false).state;
    EXPECT_NEAR(state.drawn_in, rest - length_of(x), rounding);
    EXPECT_NEAR(state.tension, 1e3 * 0.3 * rest * (length_of(x) - rest + 1), 1e4 * rounding);
}

TEST(TendonFriction, DerivativesOfForcesAreHessianAndSliding) {
    Points path = arc(0.6, 4);
    path(2, 2) = 0.8;
    Points x = path;
    x.row(1) += Eigen::RowVector3d(0.1, -0.2, 0.1);
    x.row(2) += Eigen::RowVector3d(-0.2, 0.1, 0.1);
    x.row(3) += Eigen::RowVector3d(0.1, 0.3, -0.1);
    const auto flat = [](const Points& points) {
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(points.data(), points.size()));
    };
    for (const bool by_length : {false, true}) {
        for (const std::vector<double>& earlier : {std::vector<double>{}, {1.05}, {3.0}}) {
            const TendonPull pull = pull_along(path, 1, earlier, by_length);
            const TendonTerms terms = tendon_terms(pull, x, false);
            const TendonSliding sliding = tendon_sliding(pull, x, false);
            const Eigen::MatrixXd J = terms.hessian + sliding.by_number * sliding.number_by_point;
            ASSERT_EQ(J.rows(), x.size());
            EXPECT_GT((J - terms.hessian).norm(), 1e-3 * J.norm());
            const double h = 1e-6;  // of which differences carry nine digits
            const auto gradient = [&](const TendonPull& tendon, const Points& at) {
                return flat(tendon_terms(tendon, at, false).gradient);
            };
            for (Eigen::Index c = 0; c < x.size(); ++c) {
                Points ahead = x, behind = x;
                ahead.data()[c] += h;
                behind.data()[c] -= h;
                EXPECT_LT(((gradient(pull, ahead) - gradient(pull, behind)) / (2 * h) - J.col(c)).norm(),
                          1e-7 * J.norm());
            }
            TendonPull more = pull, less = pull, held = pull;
            more.value += h;
            less.value -= h;
            const Eigen::VectorXd by_value = flat(terms.by_value);
            EXPECT_LT(((gradient(more, x) - gradient(less, x)) / (2 * h) - by_value).norm(), 1e-7 * by_value.norm());
            held.friction = tendon_friction(pull, x, false);
            EXPECT_LT((gradient(held, x) - gradient(pull, x)).norm(), 1e-12 * gradient(pull, x).norm());
        }
    }
}

}  // namespace
}  // namespace palpate::fem
