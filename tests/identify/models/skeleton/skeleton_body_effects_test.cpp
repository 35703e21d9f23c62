#include <gtest/gtest.h>

#include <random>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "identify/inference/domains/position/position_domain.h"
#include "skeleton/effects/link_effects.h"
#include "tests/identify/domains.h"
#include "tests/identify/lattice.h"
#include "tests/identify/small_body.h"

// The skeleton's fits with effects in force that are in its links and its cavities: every derivative is that of whole
// equilibria.

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

const std::vector<skeleton::EffectRecord> link_effects{
    {"stiffening", {{"c2", 0.5, "1"}, {"c3", 2, "1"}}},
    {"anisotropy", {{"k", 2, "1"}, {"nx", 1, "1"}, {"ny", 1, "1"}, {"nz", 0, "1"}}},
    {"prestress",
     {{"sxx", 0.1, "1"}, {"syy", 0.05, "1"}, {"szz", 0, "1"}, {"sxy", 0, "1"}, {"syz", 0, "1"}, {"sxz", 0, "1"}}},
    {"inclusion", {{"cx", 40, "mm"}, {"cy", 40, "mm"}, {"cz", 0, "mm"}, {"radius", 30, "mm"}, {"ratio", 3, "1"}}},
    {"plasticity", {{"yield", 0.05, "1"}, {"hardening", 0.5, "1"}}},
    {"damage", {{"share", 0.5, "1"}, {"strain", 0.05, "1"}}},
    {"torsion", {{"torsion", 0.4, "1"}}},
    {"shear", {{"shear", 0.3, "1"}}}};

skeleton::Model lattice_under_all(EquilibriumLaw law) {
    skeleton::Model model = make_lattice({3, 3, 1});
    model.law = law;
    model.effects = link_effects;
    return model;
}

// --- Calibration --------------------------------------------------------------------------------------------------

class CalibrationWithEffects : public testing::TestWithParam<std::tuple<EquilibriumLaw, Scope>> {};

TEST_P(CalibrationWithEffects, GradientIsThatOfChiSquared) {
    const auto [law, scope] = GetParam();
    const skeleton::Model model = lattice_under_all(law);
    skeleton::Model truth = model;
    for (skeleton::Link& link : truth.links) link.stiffness.head<2>() << 1.5, 500;
    std::vector<Marker> markers = markers_on_spheres(model);
    markers.resize(8);
    const MeasurementSet set =
        simulate_measurements(truth, push_spheres(model, {{0, 0, -2}, {4, 3, 0}, {10, 0, 0}}), markers, 0.05);
    const PositionDomain domain = make_domain(model, scope, set);
    const Eigen::VectorXd theta = 0.1 * Eigen::VectorXd::LinSpaced(domain.parameters().size(), -1, 1);
    const Eigen::VectorXd gradient = domain.jacobian(theta, domain.predict(theta, 1)).gradient();
    const Eigen::VectorXd numeric = numeric_gradient(domain, theta);
    EXPECT_LT((gradient - numeric).norm(), 1e-5 * numeric.norm());  // differences of step 1e-5 carry seven digits
}

// A body that yields goes through all states: what it has flowed in one pulls in those after it, whoever read them.
TEST(CalibrationWithEffects, GradientKnowsWhatHasFlowed) {
    const skeleton::Model model = lattice_under_all(EquilibriumLaw::large_rotation);
    skeleton::Model truth = model;
    for (skeleton::Link& link : truth.links) link.stiffness.head<2>() << 1.5, 500;
    std::vector<Marker> markers = markers_on_spheres(model);
    markers.resize(8);
    MeasurementSet set = simulate_measurements(
        truth, push_spheres(model, {{0, 0, -9}, {0, 0, 0}, {14, 3, 0}, {0, 8, 0}, {0, 0, 0}}), markers, 0.05);
    set.continuous = true;
    for (const int unmeasured : {2, 3}) set.states[unmeasured].readings.clear();
    const PositionDomain domain = make_domain(model, Scope::links, set);
    const Eigen::VectorXd theta = 0.1 * Eigen::VectorXd::LinSpaced(domain.parameters().size(), -1, 1);
    const Prediction there = domain.predict(theta, 1);
    const ErrorJacobian jacobian = domain.jacobian(theta, there);
    const Eigen::VectorXd gradient = jacobian.gradient();
    const Eigen::VectorXd numeric = numeric_gradient(domain, theta);
    // Differences of step 1e-5 carry seven digits, but for the fibres that begin to yield on the way.
    EXPECT_LT((gradient - numeric).norm(), 1e-4 * numeric.norm());
    EXPECT_TRUE(
        std::ranges::any_of(there.equilibria.back().before, [](const auto& f) { return f.accumulated > 0.01; }));

    // J^T J from both sides
    const Eigen::VectorXd v = theta.array().sin();
    EXPECT_EQ(jacobian.steps(v).cols(), 5) << "states that were not read too";
    double squares = 0;
    for (int s = 0; s < 3; ++s) {
        squares += jacobian.moved_markers(s, v).col(0).cwiseAbs2().dot(jacobian.weights(s));
    }
    EXPECT_NEAR(v.dot(jacobian.curvature_times(v).col(0)), squares, 1e-9 * squares);
}

INSTANTIATE_TEST_SUITE_P(Laws, CalibrationWithEffects,
                         testing::Combine(testing::Values(EquilibriumLaw::linear, EquilibriumLaw::large_rotation),
                                          testing::Values(Scope::uniform, Scope::links)));

TEST(CalibrationWithEffects, PredictsTheModelsOwnEquilibria) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        skeleton::Model model = lattice_under_all(law);
        model.links[3].length *= 0.98;  // pulls at rest
        const MeasurementSet set =
            simulate_measurements(model, push_spheres(model, {{0, 0, -2}, {4, 3, 0}}), markers_on_spheres(model));
        const PositionDomain domain = make_domain(model, Scope::uniform, set);
        const Prediction prediction = domain.predict(Eigen::VectorXd::Zero(domain.parameters().size()), 1);
        for (std::size_t s = 0; s < prediction.markers.size(); ++s) {
            // equilibria known to 1e-9 of 5 N over stiffnesses of 1 N/mm
            EXPECT_LT((prediction.markers[s] - domain.states()[s].measured).cwiseAbs().maxCoeff(), 1e-7);
        }
    }
}

TEST(CalibrationWithEffects, CommonFactorLeavesOutWhatLinksPullByThemselves) {
    skeleton::Model model = lattice_under_all(EquilibriumLaw::linear);
    const MeasurementSet set = simulate_measurements(model, push_spheres(model, {{0, 0, -5}, {5, 0, 0}, {0, 5, 0}}),
                                                     markers_on_spheres(model));
    for (skeleton::Link& link : model.links) link.stiffness /= 250;
    const PositionDomain domain = make_domain(model, Scope::zones, set);
    EXPECT_NEAR(domain.common_factor(Eigen::VectorXd::Zero(domain.parameters().size())), std::log(250), 1e-9);
}

// --- The skeleton as a model --------------------------------------------------------------------------------------

// A hollow bar under all effects, after another load has made it flow.
class SkeletonUnderAll : public testing::TestWithParam<int> {
protected:
    SkeletonUnderAll() {
        setting_ = bare_truth(model_, GetParam()).setting();
        setting_.theta.array() += 0.1;
        const Mat3 S = Vec3(0.05, -0.1, 0.02).asDiagonal();
        setting_.effects = {.material = {std::make_shared<fem::Stiffening>(0.5, 2),
                                         std::make_shared<fem::Anisotropy>(std::vector<fem::Fibre>{{2, {1, 1, 0}}}),
                                         std::make_shared<fem::Prestress>(S),
                                         std::make_shared<fem::Inclusion>(fem::Inclusion::sphere({22, 5, 5}, 8, 3))},
                            .pressure = 0.01,
                            .plasticity = fem::Plasticity{0.02, 0.5},
                            .damage = fem::Damage{0.5, 0.05},
                            .of_model = {skeleton::in_links({.torsion = 0.4, .shear = 0.3})}};
        Action pushed{.contacts = {SmallBody::probes(0.12)[1].contacts[0]}};
        action_.memory = model_.remember(model_.equilibrium(setting_, pushed, nullptr), setting_, pushed);
        action_.contacts = {SmallBody::probes()[1].contacts[0], SmallBody::probes(0.05)[3].contacts[0]};
        action_.pressure = 0.02;
        q_ = model_.equilibrium(setting_, action_, nullptr);
    }

    Eigen::MatrixXd random_steps() const {
        std::mt19937_64 engine(3);
        std::uniform_real_distribution<double> uniform(-1, 1);
        Eigen::MatrixXd steps = Eigen::MatrixXd::NullaryExpr(model_.dofs(), 4, [&] { return uniform(engine); });
        steps.topRows<6>().setZero();  // held
        return steps;
    }

    const SmallBody body_ = SmallBody::hollow();
    const SkeletonBody model_{body_.chain(), body_.markers, SmallBody::young};
    ModelSetting setting_;
    Action action_;
    Eigen::VectorXd q_;
};

TEST_P(SkeletonUnderAll, NetForcesVanishInEquilibrium) {
    EXPECT_TRUE(model_.has_cavities());
    const double load = model_.residual(model_.rest(setting_), setting_, action_).norm();
    EXPECT_LT(model_.residual(q_, setting_, action_).tail(24).norm(), 1e-6 * load);  // 1e-9, torques over 10 mm
    // Memory and pressure count.
    Action virgin = action_, flat = action_;
    virgin.memory = nullptr;
    flat.pressure = 0;
    EXPECT_EQ((model_.residual(q_, setting_, virgin) - model_.residual(q_, setting_, action_)).norm() > 1e-3,
              GetParam() == 1);  // by the linear law nothing had flowed
    EXPECT_GT((model_.residual(q_, setting_, flat) - model_.residual(q_, setting_, action_)).norm(), 1e-3);
}

TEST_P(SkeletonUnderAll, TangentIsMinusTheDerivativeOfTheResidual) {
    const Eigen::MatrixXd steps = random_steps();
    const Eigen::MatrixXd J = model_.tangent_times(q_, setting_, action_, steps);
    constexpr double h = 1e-5;
    for (Eigen::Index c = 0; c < steps.cols(); ++c) {
        const Eigen::VectorXd difference =
            (model_.residual(model_.advance(q_, h * steps.col(c), setting_), setting_, action_) -
             model_.residual(model_.advance(q_, -h * steps.col(c), setting_), setting_, action_)) /
            (2 * h);
        // rows of what is held see torques in turned frames
        EXPECT_LT((J.col(c) + difference).tail(24).norm(), 1e-6 * J.col(c).norm()) << c;
    }
    const Eigen::MatrixXd X = model_.tangent(q_, setting_, action_)->solve(J);
    EXPECT_LT((X - steps).norm(), 1e-8 * steps.norm());  // rounding times a condition of some 1e5
}

TEST_P(SkeletonUnderAll, SensitivityIsThatOfEquilibria) {
    const auto tangent = model_.tangent(q_, setting_, action_);
    const Eigen::MatrixXd A =
        model_.observation(q_, setting_) * tangent->solve(model_.parameter_force(q_, setting_, action_));
    constexpr double h = 1e-4;
    for (Eigen::Index p = 0; p < A.cols(); ++p) {
        ModelSetting ahead = setting_, behind = setting_;
        ahead.theta[p] += h;
        behind.theta[p] -= h;
        const Points difference = model_.observe(model_.equilibrium(ahead, action_, &q_), ahead) -
                                  model_.observe(model_.equilibrium(behind, action_, &q_), behind);
        const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
        // h^2, and equilibria known to 1e-9 of 0.1 N through 100 mm/N, over h
        EXPECT_LT((flat / (2 * h) - A.col(p)).norm(), 1e-5 * A.col(p).norm() + 1e-4) << p;
    }
}

TEST_P(SkeletonUnderAll, PiecesTogetherAreWhatStiffens) {
    const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(model_.pieces().rows(), 1);
    const Eigen::VectorXd all = model_.piece_force(q_, setting_, action_, ones);
    const Eigen::VectorXd expected = model_.parameter_force(q_, setting_, action_).rowwise().sum();
    EXPECT_LT((all - expected).norm(), 1e-12 * expected.norm());  // rounding
}

TEST(SkeletonThatGrew, CarriesMarkersAsFarOutAsTheModelDoes) {
    const SmallBody body;
    const skeleton::EffectRecord effect{
        "local-swelling",
        {{"cx", 25, "mm"}, {"cy", 5, "mm"}, {"cz", 5, "mm"}, {"radius", 9, "mm"}, {"growth", 0.1, "1"}}};
    for (const int law : {0, 1}) {
        const SkeletonBody judged(body.chain(), body.markers, SmallBody::young);
        ModelSetting setting = bare_truth(judged, law).setting();
        setting.effects = skeleton::make_physics(effect);
        const Points seen = judged.observe(judged.equilibrium(setting, {}, nullptr), setting);

        skeleton::Model model = body.chain();
        model.law = static_cast<EquilibriumLaw>(law);
        const std::vector<StateReadings> readings = collect_readings(model, body.set(SmallBody::probes()));
        model.effects = {effect};
        const Points expected = observe(model, equilibrium(model, {}), readings.front().points);
        EXPECT_LT((seen - expected).cwiseAbs().maxCoeff(), 1e-8) << law;  // equilibria, each to 1e-9 of its forces
        EXPECT_GT((seen - observe(model, skeleton::rest_state(model), readings.front().points)).norm(), 1);
    }
}

INSTANTIATE_TEST_SUITE_P(Laws, SkeletonUnderAll, testing::Values(0, 1),
                         [](const auto& law) { return law.param == 0 ? "Linear" : "LargeRotation"; });

}  // namespace
}  // namespace palpate::identify
