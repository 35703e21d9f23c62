#include "identify/diagnosis/ladder/ladder.h"
#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// The bar gripped at its free end and moved, as a robot or a tester does, by up to a fifth of its length.
class MovedByAGrip : public Diagnosed {
protected:
    MovedByAGrip() {
        rig_.tools.push_back({.name = "grip",
                              .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(35, -1, -1), Vec3(41, 11, 11)}}},
                              .bonded = true,
                              .origin = Vec3(37.5, 5, 5)});
        model_ =
            std::make_unique<ReferenceBody>(body_.mesh, body_.supports, body_.markers,
                                            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig_});
    }

    /// `reads`: 0 where the load cell reads, NaN where it does not.
    MeasurementSet moved(const Explanation& hidden, const Vec3& reads = Vec3::Zero()) const {
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (const Vec3& u : {Vec3(0, 4, 0), Vec3(0, 0, -5), Vec3(2, 0, 0), Vec3(-1, 3, 3), Vec3(0, -4, 2),
                              Vec3(0, 8, 0), Vec3(3, 0, 6)}) {
            LoadState state{.probe = static_cast<int>(states.size()), .time = 1};
            state.motions = {{.tool = 0, .translation = u}};
            state.reactions = {{.tool = 0, .force = reads}};
            states.push_back(state);
        }
        MeasurementSet set = body_.set(std::move(states));
        set.tools = rig_.tools;
        set.reaction_noise = 1e-4;  // [N], next to some 20 mN
        return make_twin(*model_, set, hidden, sigma);
    }

    /// The same readings as displacements since a state, which keeps none.
    static MeasurementSet since(MeasurementSet set, std::size_t from) {
        const std::vector<Reading> counted = set.states[from].readings;
        const StateName name{set.states[from].probe, set.states[from].time};
        set.states[from].readings.clear();
        for (LoadState& state : set.states)
            for (std::size_t r = 0; r < state.readings.size(); ++r) {
                state.readings[r].position += set.markers[state.readings[r].marker].rest - counted[r].position;
                state.readings[r].since = name;
            }
        return set;
    }

    static double young(const Diagnosis& found) { return std::exp(found.baseline.explanation.theta[0]); }
    static double sd_of_ln_young(const Diagnosis& found) { return std::sqrt(found.baseline.covariance(0, 0)); }

    Rig rig_;
};

TEST_F(MovedByAGrip, YoungsModulusComesFromTheReactions) {
    const Diagnosis found = diagnose(moved(truth()));
    EXPECT_EQ(found.verdict, Verdict::adequate);
    EXPECT_LT(found.baseline.whitened_rms, 1.1);
    EXPECT_NEAR(young(found), SmallBody::young, 4 * sd_of_ln_young(found) * SmallBody::young);
    // Play and compliance of 2 % each blur it: at most 2 sqrt(2) %.
    EXPECT_LT(sd_of_ln_young(found), 0.03);
}

TEST_F(MovedByAGrip, ALoadCellOfOneAxisIsEnough) {
    const Diagnosis found = diagnose(moved(truth(), Vec3(missing, 0, missing)));
    EXPECT_EQ(found.verdict, Verdict::adequate);
    EXPECT_NEAR(young(found), SmallBody::young, 0.03 * SmallBody::young);
}

TEST_F(MovedByAGrip, WithoutAForceStiffnessIsARatio) {
    const MeasurementSet told = moved(truth());
    MeasurementSet set = told;
    for (LoadState& state : set.states) state.reactions.clear();
    const Diagnosis found = diagnose(set);
    EXPECT_EQ(found.verdict, Verdict::adequate);
    // What it is believed to be before the measurements is all that is known of E; of nu they tell.
    EXPECT_NEAR(sd_of_ln_young(found), found.baseline.prior_sd[0], 0.05 * found.baseline.prior_sd[0]);
    EXPECT_LT(std::sqrt(found.baseline.covariance(1, 1)), 0.5 * found.baseline.prior_sd[1]);
}

TEST_F(MovedByAGrip, AHiddenWeightIsNamed) {
    const Diagnosis found = diagnose(moved(truth("gravity", half_g)));
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_EQ(found.explanation, std::vector<std::string>{"gravity"});
    EXPECT_NEAR(estimate(candidate(found, "gravity"), "gz"), 9810 * half_g.z(), 0.1 * 9810 * 0.5);
}

TEST_F(MovedByAGrip, AStateThatTheGripCannotBeInIsLeftOut) {
    MeasurementSet set = moved(truth("gravity", half_g));
    LoadState beyond = set.states.back();
    beyond.probe = 20;
    beyond.motions.front().translation = Vec3(-60, 0, 0);  // through the support
    set.states.push_back(beyond);
    const Diagnosis found = diagnose(set);
    EXPECT_EQ(found.explanation, std::vector<std::string>{"gravity"});
    EXPECT_EQ(std::ranges::count(found.problem.probe, 20), 0);
    EXPECT_THAT(found.notes, Contains(AllOf(HasSubstr("\"grip\""), HasSubstr("probe 20"), HasSubstr("is left out"))));
    EXPECT_THAT(found.notes, Not(Contains(HasSubstr("has no equilibrium"))));
}

TEST_F(MovedByAGrip, DisplacementsSinceALoadedStateAreDifferences) {
    const MeasurementSet positions = moved(truth());
    const Problem whole = make_problem(positions, 1), problem = make_problem(since(positions, 3), 1);
    const Eigen::VectorXd modelled = problem.pick(solve_forward(*model_, problem, truth(), 1).markers);
    // The twin's noise is on both states.
    EXPECT_LT(problem.rms_mm(problem.measured - modelled), 1.5 * std::sqrt(2) * sigma);
    EXPECT_GT(problem.rms_mm(modelled), 20 * sigma);
    EXPECT_EQ(problem.displacement(), problem.measured);  // nothing comes off a difference
    EXPECT_EQ(problem.actions.size(), whole.actions.size());
    EXPECT_LT(problem.rows(), whole.rows());
    // Without the state that they count from there is nothing to read.
    std::vector<char> drop(problem.actions.size(), 0);
    drop[problem.since[0]] = 1;
    const Problem left = problem.without_actions(drop);
    for (Eigen::Index n = 0; n < left.rows(); ++n) EXPECT_FALSE(left.is_position(n));

    const Diagnosis found = diagnose(since(positions, 3));
    EXPECT_EQ(found.verdict, Verdict::adequate);
    EXPECT_NEAR(young(found), SmallBody::young, 4 * sd_of_ln_young(found) * SmallBody::young);
}

TEST_F(MovedByAGrip, ASkeletonIsFittedToDifferencesAsToPositions) {
    const MeasurementSet positions = moved(truth()), differences = since(positions, 3);
    ASSERT_TRUE(is_rigged(differences));
    IdentifyOptions few;
    few.particles = 10;
    const skeleton::Model fitted = identify_rigged(body_.chain(), differences, few).model;
    const std::vector<Points> at = predict_rigged(fitted, positions, 1).positions,
                              of = predict_rigged(fitted, differences, 1).positions;
    for (std::size_t s = 0; s < at.size(); ++s) {
        if (s == 3) continue;
        for (Eigen::Index r = 0; r < at[s].rows(); ++r) {
            const Vec3 rest = positions.markers[positions.states[s].readings[r].marker].rest;
            EXPECT_LT((at[s].row(r) - at[3].row(r) - (of[s].row(r) - rest.transpose())).norm(), 1e-6);
        }
    }
}

TEST_F(MovedByAGrip, TheModelThatIsDeliveredTellsTheSlipThatWasFound) {
    constexpr double share = 0.8;
    MeasurementSet set = moved(truth());
    for (LoadState& state : set.states)
        for (mesh::ToolMotion& motion : state.motions) motion.translation /= share;
    LadderOptions options;
    options.identify.scope = Scope::uniform;
    options.identify.particles = 50;
    const Ladder ladder = build_ladder(body_.chain(), *model_, set, {"slip"}, options);
    const std::vector<skeleton::EffectRecord>& told = ladder.steps.back().model.effects;
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0].name, "slip");
    EXPECT_NEAR(told[0].parameters[0].value, share, 0.03);  // play and compliance of 2 % each
    EXPECT_EQ(told[0].parameters[0].value, ladder.steps.back().effects[0].parameters[0].value);
}

TEST_F(MovedByAGrip, ForcesAloneDecideWhatMakesAModelBetter) {
    MeasurementSet set = moved(truth("stiffening", Eigen::Vector2d(1, 0)));
    for (LoadState& state : set.states) state.readings.clear();
    LadderOptions options;
    options.identify.scope = Scope::uniform;
    options.identify.particles = 50;
    options.diagnose.law = neo_hookean;
    options.only_better = true;
    const Ladder ladder = build_ladder(body_.chain(), *model_, set, {"stiffening"}, options);
    EXPECT_TRUE(ladder.not_added.empty()) << ladder.not_added.front().why;
    ASSERT_EQ(ladder.steps.size(), 2u);
    const LadderStep &bare = ladder.steps[0], &stiffening = ladder.steps[1];
    EXPECT_EQ(bare.skeleton.rms_mm, 0) << "no position was read";
    EXPECT_GT(bare.reference->rms_n, 10 * *set.reaction_noise) << "the effect shows";
    EXPECT_LT(stiffening.reference->rms_n, 0.1 * bare.reference->rms_n);  // up to play and compliance
    EXPECT_LT(stiffening.reference->held_out_rms_n, 0.5 * bare.reference->held_out_rms_n);
    EXPECT_LT(stiffening.skeleton.held_out_rms_n, bare.skeleton.held_out_rms_n);
    EXPECT_LT(stiffening.skeleton.relative, bare.skeleton.relative);
}

TEST_F(MovedByAGrip, SensitivitiesAreDerivativesOfReactionsToo) {
    for (const bool differences : {false, true}) {
        const MeasurementSet set = differences ? since(moved(truth()), 3) : moved(truth());
        const Problem problem = make_problem(set, 1);
        const Explanation at = truth();
        const ForwardSolution forward = solve_forward(*model_, problem, at, 1);
        const Eigen::MatrixXd columns =
            sensitivities(*model_, problem, at, forward, {own_signatures(*model_, problem, at, forward)}, 1).front() +
            seen_directly(*model_, problem, at, forward);
        for (Eigen::Index p = 0; p < 2; ++p) {
            constexpr double h = 2e-3;  // of a logarithm: the third derivative alters 1e-6 of it
            Explanation ahead = at, behind = at;
            ahead.theta[p] += h;
            behind.theta[p] -= h;
            const Eigen::VectorXd difference = (problem.pick(solve_forward(*model_, problem, ahead, 1).markers) -
                                                problem.pick(solve_forward(*model_, problem, behind, 1).markers))
                                                   .cwiseQuotient(2 * h * problem.sigma);
            // Newton ends with some 1e-8 N left of 20 mN, which differences over 4e-3 raise to 1e-4.
            EXPECT_LT((columns.col(p) - difference).norm(), 2e-4 * difference.norm());
        }
    }
}

}  // namespace
}  // namespace palpate::identify
