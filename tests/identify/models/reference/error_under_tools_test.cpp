#include <gtest/gtest.h>

#include "identify/diagnosis/statistics/discretisation.h"
#include "mesh/errors.h"
#include "tests/identify/bar_under_ball.h"

namespace palpate::identify {
namespace {

/// What a finer mesh alters in a bar that a ball presses down.
class ErrorUnderTools : public testing::Test, public BarUnderBall {
protected:
    template <class Body = ReferenceBody>
    Body offered(const mesh::VolumeMesh& finer) const {
        ReferenceBodyOptions options{.young = 0.1, .rig = rig()};
        options.finer_under_tools =
            [mesh = std::make_shared<const mesh::VolumeMesh>(finer)](const std::vector<mesh::ToolMotion>&) {
                return FinerMesh{mesh, 2};
            };
        return {body.mesh, body.supports, body.markers, options};
    }
    static std::optional<MeshError> told(const ReferenceBody& model, const ModelSetting& setting,
                                         const Eigen::VectorXd& q) {
        return model.discretisation_error(q, setting, pressed(depth), *model.tangent(q, setting, pressed(depth)));
    }
    static constexpr double depth = 18.5;
};

TEST_F(ErrorUnderTools, IsThatOfTheEquilibriumWhichTheBodyIsIn) {
    BarUnderBall fine;
    fine.body.mesh = mesh_of({12, 3, 3});
    const ReferenceBody model = offered(fine.body.mesh);
    const auto truth = fine.reference();
    const ModelSetting setting = bare_truth(model, 2).setting();
    const Eigen::VectorXd q = brought_to(model, setting, depth), exact = brought_to(*truth, setting, depth);
    const auto error = told(model, setting, q);
    ASSERT_TRUE(error);
    const Points moved = truth->observe(exact, setting) - model.observe(q, setting);
    EXPECT_LT((error->markers - moved).norm(), 1e-3 * moved.norm());
    const Eigen::VectorXd pushed =
        truth->reactions(exact, setting, pressed(depth)) - model.reactions(q, setting, pressed(depth));
    EXPECT_LT((error->reactions - pushed).norm(), 1e-3 * pushed.norm());
}

TEST_F(ErrorUnderTools, OfABodyThatStandsElsewhereIsNone) {
    // A stump, beside which the ball goes by.
    const ReferenceBody model = offered(mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(15, 10, 10), {6, 3, 3})));
    const ModelSetting setting = bare_truth(model, 2).setting();
    const Eigen::VectorXd q = brought_to(model, setting, depth);
    EXPECT_FALSE(told(model, setting, q));
}

/// A body that cannot tell the first time that it is asked of forces, or of tools.
class ReluctantBody : public ReferenceBody {
public:
    using ReferenceBody::ReferenceBody;
    std::optional<MeshError> discretisation_error(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                  const Action& action, const Tangent& tangent) const override {
        int& asked = action.motions.empty() ? asked_of_forces : asked_of_tools;
        if (asked++ == 0) throw SolverFailure("on the verge of buckling");
        return ReferenceBody::discretisation_error(q, setting, action, tangent);
    }
    mutable int asked_of_forces = 0, asked_of_tools = 0;
};

TEST_F(ErrorUnderTools, IsAskedForAgainWhereItCouldNotBeTold) {
    const auto model = offered<ReluctantBody>(mesh_of({12, 3, 3}));
    std::vector<LoadState> states = SmallBody::probes(0.03, 2);
    for (const double now : {2.0, 4.0}) states.push_back({.probe = 3, .time = now, .motions = pressed(now).motions});
    MeasurementSet set = body.set(std::move(states));
    set.tools = rig().tools;
    Problem problem = make_problem(set, 1e-3);
    const Explanation bare = bare_truth(model, 2);
    const ForwardSolution forward = solve_forward(model, problem, bare, 1);
    const auto is_told = [&] {
        problem.correct_for(discretisation_error(model, problem, bare, forward, 1));
        std::vector<int> told(problem.actions.size(), 0);
        for (Eigen::Index n = 0; n < problem.rows(); ++n)
            if (problem.discretisation[n] != 0) told[problem.action[n]] = 1;
        return told;
    };
    // At rest, under two forces, and under the ball twice.
    EXPECT_EQ(is_told(), (std::vector{0, 1, 1, 0, 1}));
    EXPECT_EQ(is_told(), (std::vector{0, 1, 1, 1, 1}));
    EXPECT_EQ(model.asked_of_tools, 4);
    EXPECT_EQ(model.asked_of_forces, 3 + 2) << "that of the state at rest, which was not told, is not worth it again";
}

}  // namespace
}  // namespace palpate::identify
