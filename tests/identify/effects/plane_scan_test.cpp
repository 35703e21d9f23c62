#include "identify/effects/plane_scan.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include <cmath>

#include "identify/diagnosis/search/screen_plan.h"
#include "identify/effects/catalogue.h"
#include "tests/identify/small_body.h"

// What planes in the way of a body would do to it, by its compliance where it stands.

namespace palpate::identify {
namespace {

constexpr double noise = 0.05;  // [mm]

class Planes : public testing::TestWithParam<int> {
protected:
    Planes() {
        bare_ = bare_truth(*model_, GetParam());
        const MeasurementSet set = body_.set(SmallBody::probes(0.03, 4));
        problem_ = make_problem(make_twin(*model_, set, bare_, 0), noise);
        played_ = solve_forward(*model_, problem_, bare_, 1);
        scan_ = std::make_unique<PlaneScan>(*model_, problem_, bare_.setting(), played_);
    }

    /// The patches of a plane's direction, and what each does to the body in action k.
    struct Patches {
        Eigen::MatrixXd forces, steps;  // (dofs x patches)
        Eigen::VectorXd height;         // above the plane [mm]
    };
    Patches patches(int k, const PlaneScan::Plane& plane) const {
        const ModelSetting setting = bare_.setting();
        const Eigen::VectorXd& q = played_.q[k];
        const Points stand = model_->skin_positions(q, setting);
        std::vector<int> own;
        for (Eigen::Index p = 0; p < scan_->pressures().cols(); ++p) {
            const Vec3 sum = scan_->pressures().col(p).reshaped(3, stand.rows()).rowwise().sum();
            if ((sum - plane.normal).norm() < 1e-9) own.push_back(static_cast<int>(p));
        }
        const Eigen::MatrixXd pressures = scan_->pressures()(Eigen::all, own);
        Patches result;
        result.forces = model_->skin_motion(q, setting).transpose() * pressures;
        result.steps = model_->tangent(q, setting, played_.actions[k])->solve(result.forces);
        const Eigen::Map<const Eigen::VectorXd> x(stand.data(), stand.size());
        result.height = (pressures.transpose() * x).array() - plane.offset;
        return result;
    }
    /// Steps of all planes in action k (dofs x planes).
    Eigen::MatrixXd pushed_back(int k) const {
        const ModelSetting setting = bare_.setting();
        const Eigen::MatrixXd forces = model_->skin_motion(played_.q[k], setting).transpose() * scan_->pressures();
        return scan_->pushed_back(k, forces, model_->tangent(played_.q[k], setting, played_.actions[k])->solve(forces));
    }

    SmallBody body_;
    std::unique_ptr<ReferenceBody> model_ = body_.reference();
    Explanation bare_;
    Problem problem_;
    ForwardSolution played_;
    std::unique_ptr<PlaneScan> scan_;
};

TEST_P(Planes, LieWhereSomeActionTakesTheBodyAndTheRestShapeDoesNot) {
    ASSERT_GT(scan_->width(), 0);
    for (const PlaneScan::Plane& plane : scan_->planes()) {
        EXPECT_NEAR(plane.normal.norm(), 1, 1e-12);
        EXPECT_LE(plane.offset, (model_->skin() * plane.normal).minCoeff() + 1e-12);
        double lowest = INFINITY;
        for (const Eigen::VectorXd& q : played_.q) {
            lowest = std::min(lowest, (model_->skin_positions(q, bare_.setting()) * plane.normal).minCoeff());
        }
        EXPECT_LT(lowest, plane.offset);
    }
}

TEST_P(Planes, PatchesPushWithOneNewtonAndNeverPull) {
    const Eigen::MatrixXd& pressures = scan_->pressures();
    ASSERT_GT(pressures.cols(), 0);
    for (Eigen::Index p = 0; p < pressures.cols(); ++p) {
        const auto forces = pressures.col(p).reshaped(3, model_->skin().rows());
        const Vec3 sum = forces.rowwise().sum();
        EXPECT_NEAR(sum.norm(), 1, 1e-9);
        EXPECT_GE((sum.transpose() * forces).minCoeff(), -1e-9) << p;
    }
}

TEST_P(Planes, ThatTheBodyDoesNotReachDoNothing) {
    int reached = 0, clear = 0;
    for (int k = 0; k < static_cast<int>(played_.q.size()); ++k) {
        const Eigen::MatrixXd steps = pushed_back(k);
        for (Eigen::Index p = 0; p < scan_->width(); ++p) {
            const Patches own = patches(k, scan_->planes()[p]);
            if (own.height.minCoeff() >= 0) {
                EXPECT_EQ(steps.col(p).norm(), 0);
                ++clear;
            } else {
                EXPECT_GT(steps.col(p).norm(), 0);
                ++reached;
            }
        }
    }
    EXPECT_GT(reached, 10);
    EXPECT_GT(clear, 10);
    EXPECT_LT(pushed_back(0).norm(), 1e-12);  // at rest, but for rounding
}

TEST_P(Planes, PushBackByForcesThatAreComplementaryToTheGaps) {
    for (int k = 1; k < static_cast<int>(played_.q.size()); ++k) {
        const Eigen::MatrixXd steps = pushed_back(k);
        for (Eigen::Index p = 0; p < scan_->width(); ++p) {
            const Patches own = patches(k, scan_->planes()[p]);
            const double depth = -own.height.minCoeff();
            if (depth <= 0) continue;
            const Eigen::VectorXd f = own.steps.colPivHouseholderQr().solve(steps.col(p));
            EXPECT_LT((own.steps * f - steps.col(p)).norm(), 1e-9 * steps.col(p).norm());  // made of its patches alone
            // The relaxation stops at changes of 1e-6 of the largest force, or after 300 sweeps.
            const Eigen::VectorXd gap = own.height + own.forces.transpose() * steps.col(p);
            EXPECT_GE(f.minCoeff(), -1e-6 * f.maxCoeff());  // no plane pulls
            EXPECT_GE(gap.minCoeff(), -1e-2 * depth);       // and none is passed
            EXPECT_LE(f.dot(gap), 1e-2 * f.sum() * depth);  // where it pushes there is no gap
        }
    }
}

TEST_P(Planes, DoWhatAPlaneInTheWayDoes) {
    // A hard plane below, that the first push takes the body through, against the nearest column of the screen.
    const double offset = -0.3;
    Eigen::VectorXd values(5);
    values << 0, 0, 1, offset, std::log(1.0);
    const auto effect = find_effect("contact");
    const ScreenPlan plan = screen_plan(*effect, *model_, problem_, bare_, played_);
    const ScreenColumns found =
        plan.columns(sensitivities(*model_, problem_, bare_, played_, {plan.signatures}, 1).front());
    ASSERT_EQ(found.columns.cols(), scan_->width());
    EXPECT_TRUE(found.one_sided);
    const Eigen::VectorXd moved =
        (problem_.pick(solve_forward(*model_, problem_, with(bare_, effect, values), 1).markers) -
         problem_.pick(played_.markers))
            .cwiseQuotient(problem_.sigma);
    ASSERT_GT(moved.norm(), 10);
    double most = 0;
    Eigen::Index best = 0;
    for (Eigen::Index p = 0; p < found.columns.cols(); ++p) {
        const double cosine = found.columns.col(p).normalized().dot(moved.normalized());
        if (cosine > most) {
            most = cosine;
            best = p;
        }
    }
    EXPECT_GT(most, 0.98);
    EXPECT_NEAR(found.columns.col(best).norm() / moved.norm(), 1, 0.3);  // offsets of the scan lie that far apart
    EXPECT_GT(scan_->planes()[best].normal.z(), 0.7);
    const Eigen::VectorXd start = plan.start(best, Eigen::VectorXd::Ones(1));
    EXPECT_EQ(start.head<3>(), scan_->planes()[best].normal);
    EXPECT_EQ(start[3], scan_->planes()[best].offset);
    // less of it is as soft as the square of that
    EXPECT_NEAR(plan.start(best, Eigen::VectorXd::Constant(1, 0.1))[4], start[4] + std::log(0.01), 1e-12);
    for (Eigen::Index p = 0; p < scan_->width(); ++p) {
        const bool same = scan_->planes()[p].normal == scan_->planes()[best].normal;
        EXPECT_EQ(plan.place(p) == plan.place(best), same);
    }
}

TEST(PlaneScan, OfABodyThatNothingMovesHasNoPlanes) {
    const SmallBody body;
    const auto model = body.reference();
    const Explanation bare = bare_truth(*model, 0);
    const Problem problem = make_problem(make_twin(*model, body.set({LoadState{.probe = 0}}), bare, 0), noise);
    const ForwardSolution forward = solve_forward(*model, problem, bare, 1);
    EXPECT_EQ(PlaneScan(*model, problem, bare.setting(), forward).width(), 0);
    EXPECT_TRUE(screen_plan(*find_effect("contact"), *model, problem, bare, forward).signatures.width == 0);
}

INSTANTIATE_TEST_SUITE_P(Laws, Planes, testing::Values(0, 2),
                         [](const auto& about) { return about.param == 0 ? "Linear" : "NeoHooke"; });

}  // namespace
}  // namespace palpate::identify
