// The two measurement models of [Burion 2008, section III], under both methods.

#include <gtest/gtest.h>

#include "identify/identify.h"
#include "identify/inference/maximum/force_fit.h"
#include "identify/numerics/random.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

struct Sheet {
    std::vector<double> kE{0.9, 2.6, 1.5}, kF{300, 850, 520};
    skeleton::Model model = make_lattice({6, 3, 1}, 3);

    MeasurementSet measured(double noise) const {
        return simulate_measurements(with_truth(model, kE, kF), push_spheres(model, six_forces(0.5, 10)),
                                     markers_on_spheres(model), noise, 3);
    }
    IdentifyResult identified(Method method, Domain domain, double noise, int particles) const {
        IdentifyOptions options;
        options.scope = Scope::zones;
        options.law = LawChoice::large_rotation;
        options.method = method;
        options.domain = domain;
        options.particles = particles;
        options.search_low = 0.05;
        options.search_high = 2;
        options.fixed = {skeleton::Stiffness::torsion};
        return identify(model, measured(noise), options);
    }
    /// Largest relative error of the means.
    double error(const IdentifyResult& result) const {
        double largest = 0;
        for (int zone = 0; zone < 3; ++zone) {
            largest = std::max({largest, std::abs(result.posterior[2 * zone].mean / kE[zone] - 1),
                                std::abs(result.posterior[2 * zone + 1].mean / kF[zone] - 1)});
        }
        return largest;
    }
};

TEST(Domains, BothFindTheTruthWithoutNoise) {
    const Sheet sheet;
    EXPECT_LT(sheet.error(sheet.identified(Method::tempered, Domain::position, 0, 50)), 1e-4);  // of model error
    EXPECT_LT(sheet.error(sheet.identified(Method::tempered, Domain::force, 0, 50)), 1e-8);     // equilibria to 1e-9
}

TEST(Domains, AlgorithmOneFindsACubeByDistancesToo) {
    const skeleton::Model model = make_lattice({3, 2, 1});
    const MeasurementSet set = simulate_measurements(with_truth(model, {1.3}, {430}),
                                                     push_spheres(model, six_forces(1, 5)), markers_on_spheres(model));
    IdentifyOptions options;
    options.scope = Scope::uniform;
    options.method = Method::burion2008;
    options.domain = Domain::position;
    options.particles = 200;
    options.search_low = 0.05;
    options.search_high = 2;
    options.fixed = {skeleton::Stiffness::torsion};
    const IdentifyResult result = identify(model, set, options);
    EXPECT_NEAR(result.posterior[0].mean, 1.3, 1e-6 * 1.3);  // without noise; equilibria to 1e-9
    EXPECT_NEAR(result.posterior[1].mean, 430, 1e-6 * 430);
    EXPECT_EQ(result.equilibria, 200 * 20 * 6);
}

TEST(Domains, NoiseInPositionsBiasesForcesAndNotPositions) {
    const Sheet sheet;
    const double noise = 0.2;  // 0.5 % of the spacing
    const IdentifyResult by_forces = sheet.identified(Method::tempered, Domain::force, noise, 50);
    EXPECT_LT(by_forces.posterior[1].mean, 0.7 * sheet.kF[0]);                                     // towards zero
    EXPECT_LT(sheet.error(sheet.identified(Method::tempered, Domain::position, noise, 50)), 0.1);  // three times 3 %
    EXPECT_NE(by_forces.notes.back().find("biases stiffness"), std::string::npos);
}

TEST(ForceFit, SlopeVanishesWhereItEnds) {
    constexpr int P = 8;
    Eigen::MatrixXd A(30, P);
    for (int p = 0; p < P; ++p) A.col(p) = RandomStream(4, 0, p).normals(30);
    const Eigen::VectorXd f = -A * Eigen::VectorXd::LinSpaced(P, 0.5, 2) + 0.3 * RandomStream(4, 1, 0).normals(30);
    const ForcePosterior posterior{{(A.transpose() * A).sparseView(), A.transpose() * f, f.squaredNorm(), 30},
                                   {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, 0.7), nullptr},
                                   0.3};
    const ForceFit fit = fit_forces(posterior, Eigen::VectorXd::Zero(P));
    constexpr double h = 1e-5;
    for (int p = 0; p < P; ++p) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(P, p);
        const double slope =
            (posterior.log_density(fit.theta + step) - posterior.log_density(fit.theta - step)) / (2 * h);
        EXPECT_NEAR(slope, 0, 1e-3);  // 1e-10 of ln density over a curvature of some 1000
    }
}

TEST(ForceDomain, ManyMultipliersAreSolvedExactly) {
    // a thousand links, each with its own numbers
    const skeleton::Model model = make_lattice({7, 7, 8});
    skeleton::Model truth = model;
    for (std::size_t l = 0; l < truth.links.size(); ++l) {
        truth.links[l].stiffness.array() *= (0.3 * RandomStream(5, 0, l).normals(3)).array().exp();
    }
    std::vector<MeasuredConfiguration> measured;
    const MeasurementSet set =
        simulate_measurements(truth, push_spheres(truth, six_forces(20, 20)), markers_on_spheres(truth));
    IdentifyOptions options;
    options.domain = Domain::force;
    options.particles = 10;
    const IdentifyResult result = identify(model, set, options);
    int informed = 0, right = 0;
    for (const PosteriorRow& row : result.posterior) {
        if (!row.informed) continue;
        ++informed;
        const int kind = row.parameter.starts_with("elongation") ? 0 : row.parameter.starts_with("flexion") ? 1 : 2;
        right += std::abs(row.q50 / truth.links[row.link].stiffness[kind] - 1) < 1e-2 ? 1 : 0;
    }
    EXPECT_GT(informed, static_cast<int>(result.posterior.size() / 2));
    EXPECT_GT(right, informed * 9 / 10);  // weakly moved ones lose digits
}

}  // namespace
}  // namespace palpate::identify
