#include "fem/effects/point/compliant_support.h"

#include <gtest/gtest.h>

#include "skeleton/effects/point_sets.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using fem::CompliantSupport;
using testing::compliant_support;
using testing::force_at;
using testing::gravity;
using testing::lattice_with_skin;
using testing::make_chain;
using testing::make_lattice;
using testing::with_effects;
using testing::with_law;

TEST(CompliantSupportEffect, GivesWayByForceOverStiffness) {
    // The springs bear all forces, so the mean of their points moves by F / k, whatever the body does.
    const double k = 5;
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model model =
            with_law(with_effects(lattice_with_skin(), {compliant_support(k), gravity({0, 0, -1e5})}), law);
        const Vec3 F(1, 2, -3);
        const Equilibrium found = equilibrium(model, force_at(model, 3, F));
        const PointSet support = point_set(model, fem::ActsOn::support);
        const Points moved = observe(model, found, support.at) - observe(model, rest_state(model), support.at);
        const Vec3 weight = 16 * 1e-6 * Vec3(0, 0, -1e5);
        EXPECT_LT((moved.transpose() * support.weights - (F + weight) / k).norm(), 1e-8);  // 1e-9 of 3 N, over k
    }
}

TEST(CompliantSupportEffect, CarriesTheBodyAlong) {
    const Model model = with_effects(make_chain(3), {compliant_support(0.1)});
    const Equilibrium found = equilibrium(model, force_at(model, 3, {0.5, 0, 0}));
    for (int i = 0; i <= 3; ++i) EXPECT_NEAR(found.step[6 * i], 0.5 / 0.1 + i * 0.5 / 2, 1e-7);  // F / k, F / kE a link
}

TEST(CompliantSupportEffect, TurnsUnderACouple) {
    // Of six points two lie on the axis: k / 6 r^2 sin(theta) each for the other four, against F a cos(theta).
    const double k = 3, r = 4, F = 2, arm = 3;
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model model = with_law(with_effects(make_chain(1), {compliant_support(k)}), law);
        Load load;
        load.forces.push_back({on_sphere(model, 0, {arm, 0, 0}), {0, F, 0}});
        const Equilibrium found = equilibrium(model, load);
        const double theta = found.step[5], tangent_of_it = F * arm / (4.0 / 6 * k * r * r);
        EXPECT_NEAR(law == EquilibriumLaw::linear ? theta : std::tan(theta), tangent_of_it, 1e-8);
        EXPECT_NEAR(found.step[1], F / k, 1e-8);
    }
}

TEST(CompliantSupportEffect, StandsCloserToTheRimWhereItTurnsMoreStiffly) {
    // A square plate of unit side, cut into cells: <r^2> = 1/6, <r^4> = 7/180.
    constexpr int n = 60;
    Points rest(n * n, 3);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) rest.row(n * i + j) << 5 + (i + 0.5) / n, -2 + (j + 0.5) / n, 1;
    }
    const Eigen::VectorXd even = Eigen::VectorXd::Constant(n * n, 1.0 / (n * n));
    const Eigen::RowVector3d centre(5.5, -1.5, 1);
    const auto second_moment = [&](const Eigen::VectorXd& weights) {
        return weights.dot((rest.rowwise() - centre).rowwise().squaredNorm());
    };
    for (const double turning : {0.7, 1.3, 1.6}) {
        const Eigen::VectorXd weights = CompliantSupport(2, turning).weights(rest, even);
        EXPECT_NEAR(weights.sum(), 1, 1e-12);
        EXPECT_LT((weights.transpose() * rest - centre).norm(), 1e-9);
        EXPECT_NEAR(second_moment(weights) / second_moment(even), turning, 1e-9);
    }
    const Eigen::VectorXd rim = CompliantSupport(2, 1.3).weights(rest, even);
    EXPECT_NEAR(rim[0] * n * n, 1 + 0.3 / (7.0 / 180 * 36 - 1) * 2, 0.1);  // about a corner, where r^2 = 3 <r^2>
    EXPECT_EQ(CompliantSupport(2).weights(rest, even), even);
}

TEST(CompliantSupportEffect, OfPointsAsFarFromTheirCentreSharesEvenly) {
    const Points rest = (Points(4, 3) << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0).finished();
    const Eigen::VectorXd even = Eigen::VectorXd::Constant(4, 0.25);
    EXPECT_EQ(CompliantSupport(2, 2).weights(rest, even), even);
}

TEST(CompliantSupportEffect, OfGreatStiffnessHolds) {
    for (Model model : {make_lattice({4, 2, 2}), lattice_with_skin()}) {
        const Load load = force_at(model, 3, {1, 2, -3});
        const Eigen::VectorXd held = equilibrium(model, load, {1e-12}).step;
        const auto difference = [&](double k) {
            return (equilibrium(with_effects(model, {compliant_support(k)}), load).step - held).norm();
        };
        EXPECT_LT(difference(1e6), 8e-4);                          // 4 N on arms of 30 mm against 1e6 N/mm
        EXPECT_NEAR(difference(1e5) / difference(1e6), 10, 0.03);  // to first order in 1 / k
    }
}

TEST(CompliantSupportEffect, SpringsInParallelAdd) {
    const Model model = lattice_with_skin();
    const Load load = force_at(model, 3, {1, 2, -3});
    const Eigen::VectorXd step = equilibrium(with_effects(model, {compliant_support(5)}), load).step;
    const Model two = with_effects(model, {compliant_support(2), compliant_support(3)});
    EXPECT_LT((equilibrium(two, load).step - step).norm(), 1e-6);  // forces known to 1e-9 of 4 N
}

}  // namespace
}  // namespace palpate::skeleton
