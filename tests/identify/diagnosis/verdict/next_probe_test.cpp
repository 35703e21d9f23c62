#include "identify/diagnosis/verdict/next_probe.h"

#include "identify/diagnosis/verdict/further_loads.h"
#include "identify/diagnosis/verdict/probe_kinds.h"
#include "identify/diagnosis/verdict/trials.h"
#include "tests/identify/diagnosed.h"

// Which probe would tell apart what the measurements leave alike.

namespace palpate::identify {
namespace {

class NextProbes : public Diagnosed {
protected:
    FittedExplanation explained(const Problem& problem, const std::string& effect,
                                const Eigen::VectorXd& values) const {
        FittedExplanation result{.effects = {find_effect(effect)}, .fit = {}};
        const bool in_stages = result.effects[0]->has_memory() && !problem.by_stage;
        result.fit = refit(*model_, in_stages ? problem.stage_by_stage() : problem, truth(effect, values), {});
        return result;
    }
    /// An effect that is there, and another, both fitted to what the first one shows.
    NextProbe next(const std::vector<LoadState>& states, const std::string& one, const Eigen::VectorXd& values,
                   const std::string& other) const {
        return next(body_.set(states), one, values, other);
    }
    NextProbe next(const MeasurementSet& set, const std::string& one, const Eigen::VectorXd& values,
                   const std::string& other) const {
        const Problem problem = make_problem(make_twin(*model_, set, truth(one, values), sigma), sigma);
        const auto numbers = find_effect(other)->numbers(*model_, problem);
        Eigen::VectorXd start(std::ssize(numbers));
        for (Eigen::Index j = 0; j < start.size(); ++j) start[j] = numbers[j].start;
        const FittedExplanation a = explained(problem, one, values), b = explained(problem, other, start);
        return separate(*model_, problem, {&a, &b}, {});
    }
};

TEST_F(NextProbes, TurnTheBodyForAWeightAndAPrestress) {
    const NextProbe probe = next(SmallBody::probes(), "gravity", half_g, "prestress");
    EXPECT_EQ(probe.kind, "orientation");
    ASSERT_TRUE(probe.turn);
    EXPECT_GT(probe.sigmas, 10);
    EXPECT_GT(probe.rms_mm, sigma);
    EXPECT_THAT(probe.why, testing::StartsWith("separates gravity from prestress: read the unloaded body turned by"));
}

TEST_F(NextProbes, TurnOrReadWhatStandsStillForAWeightAndAFrame) {
    const NextProbe probe = next(SmallBody::probes(), "gravity", Vec3(0, 0, -0.5), "misalignment");
    EXPECT_THAT(probe.kind, testing::AnyOf("fiducials", "orientation"));
    EXPECT_GT(probe.sigmas, 10);
    if (probe.turn) {
        EXPECT_LT(std::abs(probe.turn->axis.z()), 0.1);  // about itself it does not turn
    }
}

TEST_F(NextProbes, HoldALoadForCreep) {
    const NextProbe probe = next(SmallBody::dwells(0.1), "viscosity", numbers({0.5, std::log(3)}), "stiffening");
    EXPECT_EQ(probe.kind, "dwell");
    EXPECT_EQ(probe.times.size(), 2u);
    EXPECT_GT(probe.sigmas, 10);
}

TEST_F(NextProbes, UnloadForPlasticity) {
    const NextProbe probe =
        next(SmallBody::releases(), "plasticity", numbers({std::log(0.03), std::log(0.3)}), "stiffening");
    EXPECT_EQ(probe.kind, "unload");
    EXPECT_GT(probe.sigmas, 10);
}

TEST_F(NextProbes, GoBackToLessForDamage) {
    const NextProbe probe = next(SmallBody::returns(0.1, 2), "damage", numbers({0.7, std::log(0.05)}), "stiffening");
    EXPECT_EQ(probe.kind, "unload");
    EXPECT_GT(probe.sigmas, 3);
    EXPECT_THAT(probe.why, testing::HasSubstr("read the body again at half the load"));
}

TEST_F(NextProbes, LetATendonBackForItsFriction) {
    Points path(5, 3);
    for (int k = 0; k < 5; ++k) path.row(k) = Eigen::RowVector3d(9 * k, 5, 8);
    MeasurementSet set = body_.set(std::vector<LoadState>(4));
    set.actuators = {{.name = "cable", .kind = mesh::TendonActuator{path, false}}};
    for (int k = 1; k < 4; ++k) {
        set.states[k].probe = k;
        set.states[k].actuations = {{.actuator = 0, .value = 0.5 * k}};  // up to half a radian
    }
    model_ = std::make_unique<ReferenceBody>(
        body_.mesh, body_.supports, body_.markers,
        ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = {{}, set.actuators}});
    const NextProbe probe = next(set, "friction", numbers({0.4}), "stiffening");
    EXPECT_EQ(probe.kind, "unload");
    EXPECT_FALSE(probe.contact);
    EXPECT_GT(probe.sigmas, 3);
    EXPECT_THAT(probe.why, testing::HasSubstr("drive it once more as far as ever, and read the body again at half"));
}

TEST_F(NextProbes, RepeatForASensorsGain) {
    Eigen::VectorXd gains = Eigen::VectorXd::Zero(8);
    gains[4] = 0.5;
    const NextProbe probe = next(SmallBody::probes(0.1), "force-gain", gains, "stiffening");
    EXPECT_EQ(probe.kind, "repeat");
    EXPECT_EQ(probe.probe, 5);
    EXPECT_GT(probe.sigmas, 3);
}

TEST_F(NextProbes, OpenTheCavitiesForAPressure) {
    body_ = SmallBody::hollow();
    model_ = body_.reference();
    const NextProbe probe = next(SmallBody::probes(0.03, 4), "pressure", numbers({0.03}), "prestress");
    EXPECT_EQ(probe.kind, "pressure");
    EXPECT_GT(probe.sigmas, 10);
    const std::vector<CandidateProbe> all =
        candidate_probes(*model_, make_problem(body_.set(SmallBody::probes()), sigma));
    EXPECT_EQ(std::ranges::count(all, "pressure", [](const CandidateProbe& t) { return t.probe.kind; }), 1);
}

TEST_F(NextProbes, WhereNothingTellsThemApartTheEffectItselfAsks) {
    const Problem problem = make_problem(twin(truth("gravity", half_g)), sigma);
    const FittedExplanation weight = explained(problem, "gravity", half_g);
    const NextProbe probe = separate(*model_, problem, {&weight, &weight}, {});
    EXPECT_EQ(probe.kind, "orientation");
    EXPECT_FALSE(probe.turn);
    EXPECT_EQ(probe.sigmas, 0);
    EXPECT_THAT(probe.why, testing::HasSubstr("two or three orientations"));
}

TEST_F(NextProbes, TrialsAreOfAllKinds) {
    const std::vector<CandidateProbe> all =
        candidate_probes(*model_, make_problem(body_.set(SmallBody::probes()), sigma));
    for (const std::string kind : {"load", "repeat", "dwell", "unload", "orientation", "fiducials"}) {
        EXPECT_TRUE(std::ranges::any_of(all, [&](const CandidateProbe& t) { return t.probe.kind == kind; })) << kind;
    }
    for (const CandidateProbe& trial : all) {
        EXPECT_THAT(probe_kinds::all, testing::Contains(testing::StrEq(trial.probe.kind)));
        EXPECT_FALSE(trial.asks.empty());
    }
    // no load of one's own to go by
    const std::vector<CandidateProbe> bare =
        candidate_probes(*model_, make_problem(body_.set({LoadState{.probe = 0}}), sigma));
    for (const CandidateProbe& trial : bare) EXPECT_THAT(trial.probe.kind, testing::AnyOf("orientation", "fiducials"));
}

TEST(DwellTimes, AreADecadeLaterThanEverAndAtOnce) {
    EXPECT_EQ(dwell_times(60).late, 600);
    EXPECT_DOUBLE_EQ(dwell_times(60).soon, 0.6);
    EXPECT_EQ(dwell_times(0).late, 100);
}

TEST(RoomOfATurnedBody, TurnsTheOtherWay) {
    // What was up for the room is along y for a body that is turned by a right angle about x.
    EXPECT_LT((room_of_turned(Vec3::UnitX(), 90) * Vec3::UnitZ() - Vec3::UnitY()).norm(), 1e-15);  // rounding
}

TEST_F(NextProbes, AGravityThatIsKnownTurnsWithTheRoom) {
    std::vector<LoadState> states = SmallBody::probes();
    for (LoadState& state : states) state.gravity = Vec3(0, 0, -9810);
    for (const CandidateProbe& trial : candidate_probes(*model_, make_problem(body_.set(states), sigma))) {
        if (!trial.probe.turn || trial.probe.turn->degrees != 180 || trial.probe.turn->axis.x() != 1) continue;
        EXPECT_LT((trial.states[0].gravity - Vec3(0, 0, 9810)).norm(), 1e-6);
        return;
    }
    FAIL() << "no half turn about x";
}

}  // namespace
}  // namespace palpate::identify
