#include "identify/inference/domains/position/position_domain.h"

#include <gtest/gtest.h>

#include "identify/inference/maximum/fit_map.h"
#include "mesh/errors.h"
#include "tests/identify/domains.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

PositionDomain make_domain(const skeleton::Model& model, EquilibriumLaw law, Scope scope, const MeasurementSet& set) {
    return {model, law, group_stiffness(model, scope), collect_readings(model, set), 1};
}

Eigen::MatrixXd curvature(const PositionDomain& domain, const Eigen::VectorXd& theta) {
    const auto P = theta.size();
    return domain.jacobian(theta, domain.predict(theta, 1)).curvature_times(Eigen::MatrixXd::Identity(P, P));
}

/// J^T W J with J by central differences: the second difference of chi^2 with the model itself measured.
Eigen::MatrixXd numeric_hessian(const PositionDomain& domain, const Eigen::VectorXd& theta) {
    constexpr double h = 1e-5;
    const auto P = theta.size();
    // weighted markers come from chi^2 of differences: polarisation over |a +- b|^2 is avoided, as sigma is even here
    std::vector<Eigen::VectorXd> columns;
    const auto flat = [](const Prediction& prediction) {
        std::vector<double> values;
        for (const Points& markers : prediction.markers)
            values.insert(values.end(), markers.data(), markers.data() + markers.size());
        return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
    };
    for (Eigen::Index p = 0; p < P; ++p) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(P, p);
        columns.push_back((flat(domain.predict(theta + step, 1)) - flat(domain.predict(theta - step, 1))) / (2 * h));
    }
    Eigen::MatrixXd H(P, P);
    for (Eigen::Index p = 0; p < P; ++p) {
        for (Eigen::Index q = 0; q < P; ++q) H(p, q) = columns[p].dot(columns[q]);
    }
    return H;
}

TEST(PositionDomain, StressBeyondBucklingAtRestIsLeftToLargeRotations) {
    // pressed along x, so that links would turn over by themselves at rest; where they stand nothing does
    skeleton::Model model = make_lattice({3, 3, 1});
    model.effects.push_back(
        {"prestress",
         {{"sxx", -0.5, "1"}, {"sxy", 0, "1"}, {"sxz", 0, "1"}, {"syy", 0, "1"}, {"syz", 0, "1"}, {"szz", 0, "1"}}});
    const MeasurementSet set = simulate_measurements(
        with_truth(model, {1.5}, {500}), push_spheres(model, {{0, 0, -2}, {4, 3, 0}}), markers_on_spheres(model), 0.05);
    const PositionDomain large = make_domain(model, EquilibriumLaw::large_rotation, Scope::uniform, set);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(large.parameters().size());
    EXPECT_EQ(large.common_factor(none), 0);
    EXPECT_NO_THROW(large.predict(none, 1));
    const PositionDomain linear = make_domain(model, EquilibriumLaw::linear, Scope::uniform, set);
    EXPECT_THROW(linear.common_factor(none), SolverFailure);
}

class BothLaws : public testing::TestWithParam<std::tuple<EquilibriumLaw, Scope>> {};

TEST_P(BothLaws, DerivativesMatchFiniteDifferences) {
    const auto [law, scope] = GetParam();
    const skeleton::Model model = with_law(make_lattice({3, 3, 1}), law);
    std::vector<Marker> markers = markers_on_spheres(model);
    markers.resize(8);
    MeasurementSet set = simulate_measurements(with_truth(model, {1.5}, {500}),
                                               push_spheres(model, {{0, 0, -2}, {4, 3, 0}}), markers, 0.05);
    PositionDomain domain = make_domain(model, law, scope, set);

    const Eigen::VectorXd theta = 0.1 * Eigen::VectorXd::LinSpaced(domain.parameters().size(), -1, 1);
    const Eigen::VectorXd exact = domain.jacobian(theta, domain.predict(theta, 1)).gradient();
    const Eigen::VectorXd gradient = numeric_gradient(domain, theta);
    // differences of step 1e-5 carry about seven digits
    EXPECT_LT((exact - gradient).norm(), 1e-5 * gradient.norm());

    // one state, so that all sigmas are equal: H = J^T J / sigma^2
    set.states.resize(1);
    domain = make_domain(model, law, scope, set);
    const Eigen::MatrixXd H = curvature(domain, theta);
    const Eigen::MatrixXd numeric = numeric_hessian(domain, theta);
    EXPECT_LT((H / H.trace() - numeric / numeric.trace()).norm(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(PositionDomain, BothLaws,
                         testing::Combine(testing::Values(EquilibriumLaw::linear, EquilibriumLaw::large_rotation),
                                          testing::Values(Scope::uniform, Scope::links)));

TEST(PositionDomain, CommonFactorIsExactByTheLinearLawHoweverFarOff) {
    skeleton::Model model = with_law(make_lattice({3, 2, 2}), EquilibriumLaw::linear);
    const MeasurementSet set = simulate_measurements(model, push_spheres(model, {{0, 0, -5}, {5, 0, 0}, {0, 5, 0}}),
                                                     markers_on_spheres(model));
    for (skeleton::Link& link : model.links) link.stiffness /= 250;
    const PositionDomain domain = make_domain(model, EquilibriumLaw::linear, Scope::zones, set);
    EXPECT_NEAR(domain.common_factor(Eigen::VectorXd::Zero(domain.parameters().size())), std::log(250), 1e-9);
}

TEST(PositionDomain, FitFindsTheTruthOfNoiselessTwins) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const skeleton::Model model = with_law(make_lattice({6, 3, 1}, 3), law);
        const std::vector<double> kE{0.9, 2.6, 1.5}, kF{300, 850, 520};
        const MeasurementSet set = simulate_measurements(
            with_truth(model, kE, kF), push_spheres(model, six_forces(0.5, 10)), markers_on_spheres(model));
        PositionDomain domain = make_domain(model, law, Scope::zones, set);
        domain.set_model_error(1e-4);
        const LogNormalPrior prior{Eigen::VectorXd::Zero(9), Eigen::VectorXd::Constant(9, 3), nullptr};
        const FitResult fit = fit_map(domain, prior, Eigen::VectorXd::Zero(9), 1, {.tolerance = 1e-12});
        EXPECT_TRUE(fit.converged);
        for (int zone = 0; zone < 3; ++zone) {
            // 1e-6; the prior's pull is the relative sigma squared, some 1e-7
            EXPECT_NEAR(fit.theta[3 * zone], std::log(kE[zone] / 2), 1e-6);
            EXPECT_NEAR(fit.theta[3 * zone + 1], std::log(kF[zone] / 750), 1e-6);
        }
    }
}

TEST(PositionDomain, EachLinkOfAChainIsFound) {
    const skeleton::Model model = with_law(make_lattice({6, 1, 1}), EquilibriumLaw::large_rotation);
    skeleton::Model truth = model;
    for (int l = 0; l < 5; ++l) truth.links[l].stiffness.head<2>() << 1.0 + 0.3 * l, 900 - 120 * l;
    const MeasurementSet set = simulate_measurements(
        truth, push_spheres(model, {{0, 0, -0.3}, {2, 0, 0}, {0, 0.3, 0}, {1, 0, 0.2}}), markers_on_spheres(model));
    PositionDomain domain = make_domain(model, EquilibriumLaw::large_rotation, Scope::links, set);
    domain.set_model_error(1e-4);
    const LogNormalPrior prior{Eigen::VectorXd::Zero(15), Eigen::VectorXd::Constant(15, 3), nullptr};
    const FitResult fit = fit_map(domain, prior, Eigen::VectorXd::Zero(15), 1, {.tolerance = 1e-12});
    const Eigen::VectorXd k = domain.parameters().stiffness(fit.theta);
    for (int l = 0; l < 5; ++l) {
        // the prior pulls by the relative sigma squared over the sensitivity squared
        EXPECT_NEAR(k[3 * l] / truth.links[l].stiffness[0], 1, 1e-4);
        EXPECT_NEAR(k[3 * l + 1] / truth.links[l].stiffness[1], 1, 1e-4);
    }
}

TEST(PositionDomain, ManyVerticesDoNotDrownThePrior) {
    // the same body seen by 4 and by 40 markers a sphere: the Hessian of the model error stays
    const skeleton::Model model = with_law(make_lattice({3, 2, 1}), EquilibriumLaw::linear);
    const std::vector<Marker> few = markers_on_spheres(model);
    std::vector<Marker> many;
    for (int i = 0; i < 10; ++i) many.insert(many.end(), few.begin(), few.end());
    const auto trace = [&](const std::vector<Marker>& markers) {
        const MeasurementSet set =
            simulate_measurements(model, push_spheres(model, {{0, 0, -1}, {5, 0, 0}, {0, 5, 0}}), markers);
        const PositionDomain domain = make_domain(model, EquilibriumLaw::linear, Scope::uniform, set);
        return curvature(domain, Eigen::VectorXd::Zero(3)).trace();
    };
    EXPECT_NEAR(trace(many) / trace(few), 1, 1e-9);  // rounding
}

TEST(PositionDomain, MissingCoordinatesCountNothing) {
    const skeleton::Model model = with_law(make_lattice({3, 2, 1}), EquilibriumLaw::linear);
    MeasurementSet set =
        simulate_measurements(model, push_spheres(model, {{0, 0, -1}, {4, 0, 0}}), markers_on_spheres(model));
    for (LoadState& state : set.states) {
        for (Reading& reading : state.readings) reading.position.x() = missing;
    }
    const PositionDomain domain = make_domain(model, EquilibriumLaw::linear, Scope::uniform, set);
    EXPECT_EQ(domain.coordinates(), 2 * 16 * 2);
    EXPECT_NEAR(domain.chi_squared(domain.predict(Eigen::VectorXd::Zero(3), 1)), 0, 1e-12);  // rounding
}

TEST(PositionDomain, LinearisedDomainAgreesWhereItWasMade) {
    const skeleton::Model model = with_law(make_lattice({4, 2, 1}), EquilibriumLaw::large_rotation);
    const MeasurementSet set =
        simulate_measurements(with_truth(model, {1.5}, {500}), push_spheres(model, {{0, 0, -2}, {5, 0, 0}, {0, 5, 0}}),
                              markers_on_spheres(model));
    const PositionDomain domain = make_domain(model, EquilibriumLaw::large_rotation, Scope::uniform, set);
    const Eigen::VectorXd theta = Eigen::VectorXd::Constant(3, -0.2);
    const Prediction prediction = domain.predict(theta, 1);
    const PositionDomain stand_in = domain.linearised(theta, prediction);
    EXPECT_NEAR(stand_in.chi_squared(stand_in.predict(theta, 1)) / domain.chi_squared(prediction), 1,
                1e-9);  // rounding
}

}  // namespace
}  // namespace palpate::identify
