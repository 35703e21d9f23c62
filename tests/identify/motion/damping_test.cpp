#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "identify/motion/damping.h"
#include "identify/motion/ringing.h"
#include "skeleton/model/attachment/attach.h"
#include "skeleton/runtime/body.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/identify/lattice.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

/// A lattice of spheres, held at one end, that vibrates in some hertz; a flat one far faster in its plane than across.
skeleton::Model ringing_bar(const Eigen::Vector3i& spheres = {4, 2, 2}) {
    skeleton::Model model = make_lattice(spheres);
    for (skeleton::Sphere& sphere : model.spheres) {
        sphere.mass = 2e-4;
        sphere.inertia = 8e-3 * Mat3::Identity();
    }
    return model;
}

int last_sphere(const skeleton::Model& model) { return static_cast<int>(model.spheres.size()) - 1; }

/// What the runtime's explicit steps make of a model that is let go: markers on its spheres' centres, which have no
/// skin to be pressed, so that a weight's share of gravity does it: gravity acts, and then none.
struct Release {
    skeleton::RayleighDamping damping;
    double pull = 300;  // [mm/s^2]
    double noise = 0.01, spacing = 0.01, lasts = 3;
    int readers = 6;  // markers, on the last spheres
};

MeasurementSet released(const skeleton::Model& model, const Release& how) {
    MeasurementSet set;
    set.name = "released";
    set.density = 1e-9;
    set.position_noise = how.noise;
    const int first = last_sphere(model) - how.readers + 1;
    for (int i = 0; i < how.readers; ++i)
        set.markers.push_back({.id = i, .rest = model.spheres[first + i].center, .anchor = {}});
    const Vec3 pulls = how.pull * Vec3(0.2, 0.5, -1).normalized();
    MotionRecording recording{.probe = 1, .loads = {}, .instants = {}};
    recording.loads.push_back({.probe = 1, .time = 0});
    recording.loads.back().gravity = pulls;
    recording.loads.push_back({.probe = 1, .time = how.lasts});
    recording.loads.back().gravity = Vec3::Zero();

    runtime::Body body(model);
    body.set_damping({how.damping.alpha, how.damping.beta});
    body.set_gravity(pulls);
    body.equilibrium();
    body.set_gravity(Vec3::Zero());
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0, how.noise);
    const int steps = static_cast<int>(std::ceil(how.spacing / (0.2 * body.stable_step())));
    for (double time = 0; time < how.lasts; time += how.spacing) {
        MotionRecording::Instant instant{.time = time, .readings = {}};
        for (int i = 0; i < how.readers; ++i) {
            const Vec3 off(noise(random), noise(random), noise(random));
            instant.readings.push_back({.marker = i, .position = body.position(first + i) + off, .sigma = missing});
        }
        recording.instants.push_back(std::move(instant));
        body.step_explicit(how.spacing / steps, steps);
    }
    set.recordings.push_back(std::move(recording));
    return set;
}

double ratio_at(const skeleton::RayleighDamping& damping, double hertz) {
    const double w = 2 * M_PI * hertz;
    return (damping.alpha / w + damping.beta * w) / 2;
}

TEST(Oscillator, FollowsItsEquationOfMotion) {
    for (const double ratio : {0.0, 0.1, 1.0, 2.5}) {
        const Oscillator oscillator{.frequency = 7, .ratio = ratio};
        Eigen::Vector2d exact(0.3, -2);
        const Eigen::Vector2d start = exact;
        const int steps = 20000;
        const double h = 0.9 / steps;
        const auto rate = [&](const Eigen::Vector2d& y) {
            return Eigen::Vector2d(y[1], -2 * ratio * 7 * y[1] - 49 * y[0]);
        };
        for (int i = 0; i < steps; ++i) exact += h * rate(exact + h / 2 * rate(exact));  // midpoint rule
        EXPECT_LT((oscillator.after(0.9, start) - exact).norm(), 1e-6) << ratio;
    }
}

TEST(Vibration, IsTheGeneralEigenproblem) {
    const skeleton::Model model = with_law(ringing_bar(), skeleton::EquilibriumLaw::linear);
    const skeleton::State rest = skeleton::rest_state(model);
    skeleton::StaticsSolver solver(model);
    const Eigen::VectorXd k = skeleton::stiffness_vector(model);
    solver.linear_steps(k, Eigen::VectorXd::Zero(model.dofs()));
    const Vibration found = vibration(model, solver, rest, 5);

    std::vector<int> moving;
    for (int i = 0; i < model.dofs(); ++i) {
        if (!model.spheres[i / 6].held) moving.push_back(i);
    }
    const Eigen::MatrixXd K = Eigen::MatrixXd(skeleton::tangent(model, rest, {}))(moving, moving);
    const Eigen::MatrixXd M =
        times_mass(model, rest, Eigen::MatrixXd::Identity(model.dofs(), model.dofs()))(moving, moving);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> exact(K, M);
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(found.frequencies[i], std::sqrt(exact.eigenvalues()[i]), 1e-6);
    const Eigen::MatrixXd unity = found.shapes.transpose() * times_mass(model, rest, found.shapes);
    EXPECT_LT((unity - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-6);
}

TEST(Damping, OfEachModeIsFoundFromAReleasedBody) {
    const skeleton::RayleighDamping truth{.alpha = 0, .beta = 0.006};
    skeleton::Model model = ringing_bar();
    const MeasurementSet set = released(model, {.damping = truth});
    const DampingResult found = identify_damping(model, set).value();
    ASSERT_GE(found.modes.size(), 2U);
    for (int i = 0; i < 2; ++i) {
        const DampedMode& mode = found.modes[i];
        const double exact = ratio_at(truth, mode.frequency);
        EXPECT_TRUE(mode.ratio.informed);
        // Noise of 0.01 mm in 5400 coordinates, of an amplitude of 0.3 mm, leaves a thousandth.
        EXPECT_NEAR(mode.ratio.q50, exact, 4e-3 * exact);
        EXPECT_NEAR(mode.measured.q50, mode.frequency, 3e-4 * mode.frequency);
    }
    EXPECT_NEAR(found.rms, 0.01, 0.1 * 0.01);  // the noise, of which modes that are left out add a twentieth
    EXPECT_NEAR(ratio_at(model.damping.value(), found.modes[0].frequency), ratio_at(truth, found.modes[0].frequency),
                0.03 * ratio_at(truth, found.modes[0].frequency));
}

TEST(Damping, ByMassIsToldFromDampingByStiffness) {
    for (const bool by_mass : {true, false}) {
        skeleton::Model model = ringing_bar({4, 3, 1});
        const skeleton::RayleighDamping truth =
            by_mass ? skeleton::RayleighDamping{3, 0} : skeleton::RayleighDamping{0, 0.01};
        const MeasurementSet set = released(model, {.damping = truth});
        const DampingResult found = identify_damping(model, set).value();
        EXPECT_EQ(found.law, by_mass ? DampingLaw::mass : DampingLaw::stiffness);
        EXPECT_NEAR(by_mass ? found.damping.alpha / truth.alpha : found.damping.beta / truth.beta, 1, 0.06);
        EXPECT_EQ(by_mass ? found.damping.beta : found.damping.alpha, 0);
    }
}

TEST(Damping, OfModesThatAreAlikeGoesWithStiffness) {
    skeleton::Model model = ringing_bar({4, 2, 2});
    const MeasurementSet set = released(model, {.damping = {.alpha = 3, .beta = 0}});
    const DampingResult found = identify_damping(model, set).value();
    EXPECT_EQ(found.law, DampingLaw::stiffness);
    EXPECT_FALSE(found.law_is_identified);
}

TEST(Damping, OfNoisyMarkersIsNoSurerThanItMayBe) {
    // much noise: intervals are wide, and hold the truth
    const skeleton::RayleighDamping truth{.alpha = 0, .beta = 0.006};
    skeleton::Model model = ringing_bar();
    const MeasurementSet set = released(model, {.damping = truth, .noise = 1, .spacing = 0.05});
    const DampingResult found = identify_damping(model, set).value();
    const double exact = ratio_at(truth, found.modes[0].frequency);
    EXPECT_LT(found.modes[0].ratio.q025, exact);
    EXPECT_GT(found.modes[0].ratio.q975, exact);
}

TEST(Damping, ScalesMassesThatNobodyTold) {
    skeleton::Model model = ringing_bar();
    MeasurementSet set = released(model, {.damping = {.alpha = 0, .beta = 0.006}});
    const double mass = model.spheres.back().mass;
    set.density.reset();
    for (skeleton::Sphere& sphere : model.spheres) {
        sphere.mass /= 1.5;
        sphere.inertia /= 1.5;
    }
    for (LoadState& load : set.recordings[0].loads) load.gravity *= 1.5;
    const DampingResult found = identify_damping(model, set).value();
    EXPECT_NEAR(found.speed.q50, 1 / std::sqrt(1.5), 0.03);
    EXPECT_NEAR(model.spheres.back().mass, mass, 0.06 * mass);
    EXPECT_THAT(found.notes, testing::Contains(testing::HasSubstr("masses were multiplied by 1.")));

    // told, they stay, and the damping is of as many cycles
    skeleton::Model estimate = ringing_bar();
    for (skeleton::Sphere& sphere : estimate.spheres) {
        sphere.mass /= 1.5;
        sphere.inertia /= 1.5;
    }
    set.density = 1e-9;
    const DampingResult same = identify_damping(estimate, set).value();
    EXPECT_DOUBLE_EQ(same.mass, 1);
    EXPECT_THAT(same.notes, testing::Contains(testing::HasSubstr("times as fast as the model")));
    EXPECT_NEAR(ratio_at(estimate.damping.value(), same.modes[0].frequency), same.ratio.q50, 0.02 * same.ratio.q50);
}

TEST(Damping, IsNothingWithoutRecordings) {
    skeleton::Model model = ringing_bar();
    EXPECT_FALSE(identify_damping(model, {}).has_value());
    EXPECT_FALSE(model.damping.has_value());
}

TEST(Damping, SaysWhatItLacks) {
    skeleton::Model model = ringing_bar();
    MeasurementSet set = released(model, {.damping = {}, .spacing = 1});
    EXPECT_THAT(message_of<InvalidInput>([&] { identify_damping(model, set); }),
                testing::HasSubstr("damping is not observable in the recordings"));
    model.spheres.back().mass = 0;
    EXPECT_THAT(message_of<InvalidInput>([&] { identify_damping(model, set); }),
                testing::HasSubstr("sphere 15 moves and has no mass"));
}

}  // namespace
}  // namespace palpate::identify
