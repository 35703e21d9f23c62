#include "identify/diagnosis/likelihood/tool_nuisances.h"
#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

/// The bar bent by a tendon along its upper side, of which more and more is drawn in.
class DrawnInByATendon : public Diagnosed {
protected:
    DrawnInByATendon() {
        Points path(5, 3);
        for (int k = 0; k < 5; ++k) path.row(k) = Eigen::RowVector3d(9 * k, 5, 8);
        rig_.actuators = {{.name = "cable", .kind = mesh::TendonActuator{path, true}}};
        model_ =
            std::make_unique<ReferenceBody>(body_.mesh, body_.supports, body_.markers,
                                            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig_});
    }

    MeasurementSet drawn_in(const Explanation& hidden) const {
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (const double length : {0.5, 1.0, 1.5, 2.0, 1.0}) {  // and back
            states.push_back({.probe = 1, .time = static_cast<double>(states.size())});
            states.back().actuations = {{.actuator = 0, .value = length}};
        }
        MeasurementSet set = body_.set(std::move(states));
        set.actuators = rig_.actuators;
        return make_twin(*model_, set, hidden, sigma);
    }

    Rig rig_;
};

TEST_F(DrawnInByATendon, NothingIsBlamedWhereNothingIsHidden) {
    const Diagnosis found = diagnose(drawn_in(truth()));
    EXPECT_EQ(found.verdict, Verdict::adequate);
    EXPECT_TRUE(found.explanation.empty());
}

TEST_F(DrawnInByATendon, ItsFrictionIsNamed) {
    const Diagnosis found = diagnose(drawn_in(truth("friction", numbers({0.4}))));
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_EQ(found.explanation, std::vector<std::string>{"friction"});
    const Candidate& friction = candidate(found, "friction");
    EXPECT_NEAR(estimate(friction, "tendons"), 0.4, 4 * friction.estimate.sd[0]);
    EXPECT_LT(friction.estimate.sd[0], 0.1);
}

TEST_F(DrawnInByATendon, SlackAndGiveAreAsMuchLessThatIsDrawnIn) {
    const MeasurementSet set = drawn_in(truth());
    const Problem problem = make_problem(set, 1);
    const Explanation at = truth();
    const ForwardSolution forward = solve_forward(*model_, problem, at, 1);
    const ToolNuisances unknown = tool_nuisances(*model_, problem, at.setting(), forward);
    EXPECT_EQ(unknown.names, (std::vector<std::string>{"slack of the tendon 'cable'", "give of the tendon 'cable'"}));
    const Eigen::MatrixXd columns = sensitivities(*model_, problem, at, forward, {unknown.signatures}, 1).front();
    const auto read = [&](double slack, double share) {
        Problem other = problem;
        for (Action& action : other.actions)
            for (mesh::ActuatorSetting& one : action.settings) one.value = (1 - share) * one.value - slack;
        return Eigen::VectorXd(problem.pick(solve_forward(*model_, other, at, 1).markers).cwiseQuotient(problem.sigma));
    };
    // Of the largest length, 2 mm, and 2.5 times as much of each; differences of step h carry equilibria's seven
    // digits.
    constexpr double h = 1e-3;
    const Eigen::VectorXd by_slack = (read(2 * h, 0) - read(-2 * h, 0)) / (2 * h);
    const Eigen::VectorXd by_give = (read(0, 2.5 * h) - read(0, -2.5 * h)) / (2 * h);
    EXPECT_LT((columns.col(0) - by_slack).norm(), 1e-3 * by_slack.norm());
    EXPECT_LT((columns.col(1) - by_give).norm(), 1e-3 * by_give.norm());
}

}  // namespace
}  // namespace palpate::identify
