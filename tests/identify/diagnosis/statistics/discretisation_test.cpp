#include "identify/diagnosis/statistics/discretisation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <tuple>

#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/likelihood/nuisances.h"
#include "identify/effects/catalogue.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

/// A plate of one element in thickness, held along an edge, which readings of a finer mesh are fitted to.
class Discretisation : public testing::Test {
protected:
    static constexpr double noise = 0.02;  // [mm]

    static mesh::VolumeMesh plate(const Eigen::Vector3i& cells) {
        return mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(60, 40, 4), cells));
    }
    Discretisation() {
        body_.mesh = plate({5, 3, 1});
        body_.supports = {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(0.1, 41, 5)}};
        body_.markers.clear();
        for (const double x : {8.0, 17.0, 26.0, 35.0, 44.0, 53.0, 59.0}) {
            for (const double y : {3.0, 12.0, 21.0, 30.0, 38.0})
                body_.markers.push_back({static_cast<int>(body_.markers.size()), Vec3(x, y, 4), {}});
        }
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (const auto& [x, y, force] :
             {std::tuple{55, 8, -0.002}, {55, 32, 0.002}, {30, 20, -0.006}, {50, 20, 0.003}}) {
            states.push_back({.probe = static_cast<int>(states.size()),
                              .time = 1,
                              .contacts = {{Vec3(x, y, 4), Vec3(0, 0, force), 5}}});
        }
        set_ = body_.set(std::move(states));
    }

    /// As a mesh of half the edges reads it, which differs from that of the body halved.
    MeasurementSet read() const {
        const ReferenceBody truth(plate({12, 8, 2}), body_.supports, body_.markers);
        return make_twin(truth, set_, bare_truth(truth, 2), noise);
    }

    Diagnosis diagnose(bool measured_on_mesh) const {
        const ReferenceBody model(body_.mesh, body_.supports, body_.markers,
                                  {.young = 0.1, .measured_on_mesh = measured_on_mesh});
        DiagnoseOptions options;
        options.screen = false;
        return identify::diagnose(model, read(), options);
    }

    SmallBody body_;
    MeasurementSet set_;
};

TEST_F(Discretisation, IsTakenOffWhatAThinPlateIsFittedTo) {
    const Diagnosis corrected = diagnose(false), plain = diagnose(true);
    const auto young = [](const Diagnosis& d) { return std::exp(d.baseline.explanation.theta[0]); };
    // Halved edges leave a quarter of the error of plates, whose bending converges with the square of the edge.
    EXPECT_LT(std::abs(young(corrected) - SmallBody::young), 0.25 * std::abs(young(plain) - SmallBody::young));
    EXPECT_EQ(corrected.verdict, Verdict::adequate);
    EXPECT_EQ(corrected.problem.discretisation.size(), corrected.problem.rows());
    EXPECT_EQ(plain.problem.discretisation.size(), 0);
}

/// A body that counts how often it is asked for the error of its mesh.
class CountingBody : public ReferenceBody {
public:
    using ReferenceBody::ReferenceBody;
    std::optional<MeshError> discretisation_error(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                  const Action& action, const Tangent& tangent) const override {
        ++asked;
        return ReferenceBody::discretisation_error(q, setting, action, tangent);
    }
    mutable int asked = 0;
};

TEST_F(Discretisation, IsComputedAgainOnlyWhileItShowsNextToWhatIsLeft) {
    const auto asked = [&](const Explanation& hidden) {
        const ReferenceBody truth(plate({12, 8, 2}), body_.supports, body_.markers);
        const CountingBody model(body_.mesh, body_.supports, body_.markers, {.young = 0.1});
        DiagnoseOptions options;
        options.screen = false;
        const Diagnosis found = identify::diagnose(model, make_twin(truth, set_, hidden, noise), options);
        const Eigen::VectorXd error = found.problem.discretisation;  // [mm]
        const double in_sigmas = error.norm() / std::sqrt(static_cast<double>(error.size())) / noise;
        return std::tuple{model.asked, found.baseline.whitened_rms, in_sigmas};
    };
    const Explanation bare = bare_truth(ReferenceBody(body_.mesh, body_.supports, body_.markers), 2);
    const auto [of_plain, left_of_plain, error_of_plain] = asked(bare);
    EXPECT_LT(left_of_plain, 1.2);
    EXPECT_GT(error_of_plain, 0.3);
    EXPECT_GT(of_plain, std::ssize(set_.states)) << "the first one alters the fit that the next is of";
    Eigen::VectorXd moved(6);
    moved << 0.2, -0.2, 0.2, 0, 0, 0;
    const auto [of_moved, left_of_moved, error_of_moved] = asked(with(bare, find_effect("misalignment"), moved));
    EXPECT_GT(left_of_moved, 3);
    EXPECT_GT(error_of_moved, 0.3) << "it shows next to noise, not next to what is left";
    EXPECT_LT(of_moved, of_plain);
}

TEST_F(Discretisation, IsToldByAFinerMeshThatIsGiven) {
    const mesh::VolumeMesh finer = plate({12, 8, 2});  // no halving of the other
    const ReferenceBody model(body_.mesh, body_.supports, body_.markers, {.finer = finer});
    const ReferenceBody truth(finer, body_.supports, body_.markers);
    const ModelSetting setting = bare_truth(model, 2).setting();
    const Action action{.contacts = set_.states[1].contacts};
    const Eigen::VectorXd q = model.equilibrium(setting, action);
    const auto error = model.discretisation_error(q, setting, action, *model.tangent(q, setting, action));
    ASSERT_TRUE(error);
    const Points expected = truth.observe(truth.equilibrium(setting, action), setting) - model.observe(q, setting);
    // A refined equilibrium ends with a twentieth to go, by an estimate that is too small where meshes do not nest; a
    // fifth of the error is less than the half that its nuisance allows for.
    EXPECT_LT((error->markers - expected).norm(), 0.2 * expected.norm());
}

TEST_F(Discretisation, OfWhatAGripFeelsIsToldToo) {
    Rig rig;
    rig.tools.push_back({.name = "grip",
                         .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(54, -1, -1), Vec3(61, 41, 5)}}},
                         .bonded = true,
                         .origin = Vec3(57, 20, 2)});
    const mesh::VolumeMesh finer = plate({20, 12, 4});
    const ReferenceBody model(plate({10, 6, 2}), body_.supports, body_.markers, {.finer = finer, .rig = rig});
    const ReferenceBody truth(finer, body_.supports, body_.markers, {.rig = rig});
    const ModelSetting setting = bare_truth(model, 2).setting();
    Action action;
    action.motions = {{.tool = 0, .translation = Vec3(1, 2, 5), .rotation = Vec3(0.05, 0.1, 0)}};
    const Eigen::VectorXd q = model.equilibrium(setting, action), exact = truth.equilibrium(setting, action);
    const auto error = model.discretisation_error(q, setting, action, *model.tangent(q, setting, action));
    ASSERT_TRUE(error);
    const Eigen::VectorXd expected = truth.reactions(exact, setting, action) - model.reactions(q, setting, action);
    EXPECT_GT(expected.norm(), 5e-4 * model.reactions(q, setting, action).norm());
    // A refined equilibrium ends with a twentieth of the displacement to go; a grip's stiff springs feel more of it.
    EXPECT_LT((error->reactions - expected).norm(), 0.25 * expected.norm());
    const Points moved = truth.observe(exact, setting) - model.observe(q, setting);
    EXPECT_LT((error->markers - moved).norm(), 0.1 * moved.norm());
}

TEST_F(Discretisation, UnderAToolThatMayPartIsToldByAMeshThatIsFinerThere) {
    Rig rig;
    rig.tools.push_back({.name = "ball", .shape = mesh::SphereShape{6}, .origin = Vec3(20, 20, 10)});
    const auto finer = std::make_shared<const mesh::VolumeMesh>(plate({15, 10, 2}));
    ReferenceBodyOptions options{.rig = rig};
    const auto offered = [&](double times) {
        options.finer_under_tools = [=](const std::vector<mesh::ToolMotion>& motions) -> FinerMesh {
            return motions.front().translation.z() < 0 ? FinerMesh{finer, times} : FinerMesh{};
        };
        return ReferenceBody(body_.mesh, body_.supports, body_.markers, options);
    };
    const ReferenceBody model = offered(4), truth(*finer, body_.supports, body_.markers, {.rig = rig});
    const ModelSetting setting = bare_truth(model, 2).setting();
    Action action;
    action.motions = {{.tool = 0, .translation = Vec3(0, 0, -1.5)}};
    for (const double deeper : {1.0, 1.1}) {  // the second starts from where it is not: from the coarse mesh
        action.motions[0].translation *= deeper;
        const Eigen::VectorXd q = model.equilibrium(setting, action), exact = truth.equilibrium(setting, action);
        const auto told = [&] {
            return model.discretisation_error(q, setting, action, *model.tangent(q, setting, action));
        };
        const auto error = told(), again = told();
        ASSERT_TRUE(error && again);
        const Eigen::VectorXd expected = truth.reactions(exact, setting, action) - model.reactions(q, setting, action);
        EXPECT_GT(expected.norm(), 0.02 * model.reactions(q, setting, action).norm()) << "a few elements under a ball";
        // Both are equilibria to a millionth of the forces.
        const double rounding = 1e-4 * expected.norm();
        EXPECT_LT((error->reactions - expected).norm(), rounding);
        EXPECT_LT((again->reactions - expected).norm(), rounding) << "from the last one";
        const Points moved = truth.observe(exact, setting) - model.observe(q, setting);
        EXPECT_LT((error->markers - moved).norm(), 1e-4 * moved.norm());
    }
    EXPECT_NEAR(*model.remaining_mesh_error(action), 1.0 / 7, 1e-12);  // e - e/8 is taken off
    EXPECT_FALSE(model.remaining_mesh_error({}));
    action.motions[0].translation.z() = 1;
    EXPECT_FALSE(model.remaining_mesh_error(action));
}

TEST_F(Discretisation, UnderToolsIsAnUnknownOfEachAction) {
    Rig rig;
    rig.tools.push_back({.name = "ball", .shape = mesh::SphereShape{6}, .origin = Vec3(20, 20, 10)});
    const auto finer = std::make_shared<const mesh::VolumeMesh>(plate({10, 6, 2}));
    ReferenceBodyOptions options{.rig = rig};
    options.finer_under_tools = [=](const std::vector<mesh::ToolMotion>&) { return FinerMesh{finer, 2}; };
    const ReferenceBody model(body_.mesh, body_.supports, body_.markers, options);
    std::vector<LoadState> states{LoadState{.probe = 0}, set_.states[1]};
    for (const double x : {0.0, 10.0}) {
        LoadState state{.probe = static_cast<int>(states.size()), .time = 1};
        state.motions = {{.tool = 0, .translation = Vec3(x, 0, -1)}};
        state.reactions = {{.tool = 0, .force = Vec3::Zero()}};
        states.push_back(state);
    }
    MeasurementSet set = body_.set(std::move(states));
    set.tools = rig.tools;
    set.reaction_noise = 1e-4;
    const Explanation bare = bare_truth(model, 2);
    Problem problem = make_problem(make_twin(model, set, bare, noise), noise);
    const ForwardSolution forward = solve_forward(model, problem, bare, 1);
    problem.correct_for(discretisation_error(model, problem, bare, forward, 1));
    const Nuisances nuisances = make_nuisances(model, problem, bare, forward, 1);
    // One for what is pressed by known forces, and one each for the two places of the ball.
    ASSERT_EQ(nuisances.of_mesh, 3);
    const Eigen::MatrixXd columns = nuisances.columns.rightCols(3);
    const Eigen::VectorXd sd = nuisances.precisions.tail(3).cwiseSqrt().cwiseInverse();
    EXPECT_NEAR(sd[0], NuisanceOptions{}.discretisation, 1e-12);
    const double left = 1 / (std::sqrt(8) - 1);  // of edges half as long
    EXPECT_NEAR(sd[1], left, 1e-12);
    EXPECT_NEAR(sd[2], left, 1e-12);
    EXPECT_LT((columns.rowwise().sum() - problem.discretisation.cwiseQuotient(problem.sigma)).norm(), 1e-12);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int others = static_cast<int>((columns.row(n).array() != 0).count());
        EXPECT_LE(others, 1);
    }
}

TEST_F(Discretisation, OfSmallerLoadsIsScaledWhereNoiseHidesTheDifference) {
    LoadState strong = set_.states[1];
    strong.contacts[0].force *= 2;
    std::vector<LoadState> states{strong};
    for (const double share : {1.0 / 3, 2.0 / 3}) {
        states.push_back(strong);
        states.back().time += share;
        states.back().contacts[0].force *= share;
    }
    const ReferenceBody model(body_.mesh, body_.supports, body_.markers);
    const MeasurementSet set = body_.set(std::move(states));
    const Explanation bare = bare_truth(model, 2);
    const auto error_at = [&](double sigma) {
        const Problem problem = make_problem(set, sigma);
        return discretisation_error(model, problem, bare, solve_forward(model, problem, bare, 1), 1);
    };
    const Eigen::VectorXd scaled = error_at(10), own = error_at(1e-3);
    ASSERT_GT(own.norm(), 0);
    EXPECT_NE(scaled, own);
    // Geometry stiffens a plate that is bent so far: a tenth of the error.
    EXPECT_LT((scaled - own).norm(), 0.1 * own.norm());
}

TEST_F(Discretisation, OfAnotherProblemIsFoundByActionAndMarker) {
    Problem whole = make_problem(set_, noise);
    whole.correct_for(Eigen::VectorXd::LinSpaced(whole.rows(), 0, 1));
    std::vector<char> drop(whole.actions.size(), 0);
    drop[1] = 1;
    Problem part = whole.without_actions(drop);
    const Eigen::VectorXd expected = part.discretisation;
    part.correct_for({});
    EXPECT_EQ(discretisation_of(whole, part), expected);
    EXPECT_EQ(discretisation_of(part, whole).size(), 0);  // which does not tell
    part.correct_for(expected);
    EXPECT_EQ(discretisation_of(part, whole).size(), 0);  // which lacks an action
}

TEST_F(Discretisation, ReadingsStayWhatTheyWere) {
    Problem problem = make_problem(set_, noise);
    const Eigen::VectorXd measured = problem.measured, moved = problem.displacement();
    problem.correct_for(Eigen::VectorXd::Constant(problem.rows(), 0.5));
    EXPECT_EQ(problem.measured, measured - Eigen::VectorXd::Constant(problem.rows(), 0.5));
    EXPECT_LT((problem.displacement() - moved).cwiseAbs().maxCoeff(), 1e-12);  // rounding
    problem.correct_for({});
    EXPECT_LT((problem.measured - measured).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace palpate::identify
