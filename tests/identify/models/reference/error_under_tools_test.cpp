#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "tests/identify/bar_under_ball.h"

namespace palpate::identify {
namespace {

/// What a finer mesh alters in a bar that a ball presses down.
class ErrorUnderTools : public testing::Test, public BarUnderBall {
protected:
    ReferenceBody offered(const mesh::VolumeMesh& finer) const {
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
    EXPECT_THROW(told(model, setting, q), SolverFailure);
}

}  // namespace
}  // namespace palpate::identify
