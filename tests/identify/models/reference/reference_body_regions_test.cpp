// A body of several materials, as a fit sees it.

#include <gmock/gmock.h>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/material_estimate.h"
#include "identify/diagnosis/search/baselines.h"
#include "tests/identify/diagnosed.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

/// The bar, its middle part along the axis and its end of materials of their own; elements are 8 mm long.
struct Regions : ::testing::Test {
    static mesh::MaterialRegion part(const std::string& name, double from, double to,
                                     std::optional<double> young = {}) {
        return {.name = name, .surface = mesh::make_box({from, -1, -1}, {to, 11, 11}, {1, 1, 1}), .young = young};
    }
    std::unique_ptr<ReferenceBody> body(const std::vector<mesh::MaterialRegion>& regions) const {
        return std::make_unique<ReferenceBody>(
            bar.mesh, bar.supports, bar.markers,
            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .regions = regions});
    }
    static Explanation truth(const BodyModel& model, std::initializer_list<double> young) {
        Explanation result;
        result.law = neo_hookean;
        result.theta.resize(std::ssize(model.parameters()));
        result.theta.head<2>() << std::log(SmallBody::young), std::log(0.1);
        Eigen::Index place = 2;
        for (const double own : young) result.theta[place++] = std::log(own);
        return result;
    }
    MaterialEstimate fit(const BodyModel& model, const MeasurementSet& set) const {
        const Problem problem = make_problem(set, sigma);
        return material_of(model, refit(model, problem, first_guess(model, problem, neo_hookean, 1), {}));
    }

    SmallBody bar;
};

TEST_F(Regions, ParameterForceIsTheDerivativeOfTheResidual) {
    std::vector<mesh::MaterialRegion> regions{part("middle", 16, 24), part("end", 32, 40)};
    regions[1].poisson = 0.3;
    const auto model = body(regions);
    ModelSetting setting = truth(*model, {2, 0.05}).setting();
    const Action action{.contacts = SmallBody::probes(0.05)[1].contacts};
    for (int law = 0; law < 3; ++law) {
        setting.law = law;
        const Eigen::VectorXd q = model->equilibrium(setting, action);
        const Eigen::MatrixXd G = model->parameter_force(q, setting, action);
        ASSERT_EQ(G.cols(), 4);
        for (Eigen::Index p = 0; p < 4; ++p) {
            constexpr double h = 1e-5;
            ModelSetting more = setting, less = setting;
            more.theta[p] += h;
            less.theta[p] -= h;
            const Eigen::VectorXd change =
                (model->residual(q, more, action) - model->residual(q, less, action)) / (2 * h);
            EXPECT_LT((G.col(p) - change).norm(), 1e-6 * change.norm()) << law << ", " << p;
        }
    }
}

TEST_F(Regions, AreFoundWithinTheirDeviations) {
    const auto model = body({part("middle", 16, 24), part("end", 32, 40)});
    const MeasurementSet set = make_twin(*model, bar.set(SmallBody::probes()), truth(*model, {2, 0.1}), sigma, 1);
    const MaterialEstimate found = fit(*model, set);
    constexpr double sigmas = 4;
    EXPECT_NEAR(found.young, SmallBody::young, sigmas * found.young_sd);
    ASSERT_EQ(found.regions.size(), 2U);
    EXPECT_EQ(found.regions[0].name, "middle");
    EXPECT_NEAR(found.regions[0].young, 2, sigmas * found.regions[0].young_sd);
    EXPECT_NEAR(found.regions[1].young, 0.1, sigmas * found.regions[1].young_sd);
    // Loads on the end and on the root bend all three: each is known to a tenth and better.
    EXPECT_LT(found.young_sd, 0.1 * found.young);
    EXPECT_LT(found.regions[1].young_sd, 0.2 * found.regions[1].young);
}

TEST_F(Regions, ThatAreKnownStayWhatTheyAre) {
    const auto hidden = body({part("middle", 16, 24)}), model = body({part("middle", 16, 24, 2.0)});
    const MeasurementSet set = make_twin(*hidden, bar.set(SmallBody::probes()), truth(*hidden, {2}), sigma, 1);
    const MaterialEstimate found = fit(*model, set);
    ASSERT_EQ(found.regions.size(), 1U);
    EXPECT_TRUE(found.regions[0].is_declared);
    EXPECT_NEAR(found.regions[0].young, 2, 1e-3);
    EXPECT_TRUE(std::isnan(found.regions[0].young_sd));
    EXPECT_NEAR(found.young, SmallBody::young, 4 * found.young_sd);
}

TEST_F(Regions, WithNextToNoElementsAreRefused) {
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body({part("thin", 16, 16.1)}); }),
                     {"region 'thin'", "0 of the mesh's elements", "at least 4"}));
}

TEST_F(Regions, WeighWhatTheirDensitySays) {
    std::vector<mesh::MaterialRegion> regions{part("end", 32, 40)};
    regions[0].density = 3e-9;
    const auto heavy = body(regions);
    const ModelSetting setting = truth(*heavy, {SmallBody::young}).setting();
    const Action fall{.contacts = {}, .gravity = Vec3(0, 0, -1000)};
    const Eigen::VectorXd none = heavy->rest(setting);
    const Eigen::VectorXd weight = heavy->residual(none, setting, fall);
    double sum = 0;
    for (Eigen::Index i = 2; i < weight.size(); i += 3) sum += weight[i];
    EXPECT_NEAR(sum, -1000 * (3200 * 1e-9 + 800 * 3e-9), 1e-12);
}

}  // namespace
}  // namespace palpate::identify
