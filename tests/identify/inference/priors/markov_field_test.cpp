#include "identify/inference/priors/markov_field.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "identify/inference/maximum/calibrate.h"
#include "identify/numerics/random.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

/// Nodes in a ring with some chords, and one node alone.
MarkovField make_field(int n, double own) {
    std::vector<MarkovField::Edge> edges;
    for (int i = 0; i + 1 < n; ++i) {
        edges.push_back({i, (i + 1) % (n - 1), 1 + 0.1 * i});
        if (i % 3 == 0) edges.push_back({i, (i + 4) % (n - 1), 0.5});
    }
    return {n, edges, own};
}

Eigen::MatrixXd root(const MarkovField& field, int n) { return field.coloured(Eigen::MatrixXd::Identity(n, n)); }

TEST(MarkovField, VariancesAreOne) {
    for (const double own : {0.01, 1.0, 100.0}) {
        const Eigen::MatrixXd C = root(make_field(20, own), 20);
        EXPECT_LT(((C * C.transpose()).diagonal().array() - 1).abs().maxCoeff(), 1e-12);  // rounding
    }
}

TEST(MarkovField, VariancesAreOneOnAGrid) {  // whose factor has columns with the same rows below them
    constexpr int side = 7, n = side * side * side;
    std::vector<MarkovField::Edge> edges;
    for (int i = 0; i < n; ++i) {
        if (i % side + 1 < side) edges.push_back({i, i + 1, 1});
        if (i / side % side + 1 < side) edges.push_back({i, i + side, 2});
        if (i + side * side < n) edges.push_back({i, i + side * side, 0.5});
    }
    const Eigen::MatrixXd C = root(MarkovField(n, edges, 0.1), n);
    EXPECT_LT((C.rowwise().squaredNorm().array() - 1).abs().maxCoeff(), 1e-12);  // rounding
}

TEST(MarkovField, PrecisionIsZeroBetweenNodesThatAreNotJoined) {
    const Eigen::MatrixXd C = root(make_field(20, 1), 20);
    const Eigen::MatrixXd precision = (C * C.transpose()).inverse();
    EXPECT_LT(precision(0, 1), -0.1);
    EXPECT_NEAR(precision(0, 2), 0, 1e-12);   // rounding
    EXPECT_NEAR(precision(0, 19), 0, 1e-12);  // the node alone
    EXPECT_NEAR(precision(19, 19), 1, 1e-12);
}

TEST(MarkovField, CorrelationFallsExponentiallyAlongAChain) {
    constexpr int n = 400;
    std::vector<MarkovField::Edge> edges;
    for (int i = 0; i + 1 < n; ++i) edges.push_back({i, i + 1, 1});
    for (const double own : {0.04, 1.0}) {
        const Eigen::MatrixXd C = root(MarkovField(n, edges, own), n);
        const double step = C.row(n / 2).dot(C.row(n / 2 + 1)), three = C.row(n / 2).dot(C.row(n / 2 + 3));
        // cosh(a) = 1 + own / 2, exactly
        EXPECT_NEAR(step, std::exp(-std::acosh(1 + own / 2)), 1e-9);
        EXPECT_NEAR(three, std::pow(step, 3), 1e-9);
    }
}

TEST(MarkovField, MapsAreInverseAndAdjoint) {
    const MarkovField field = make_field(20, 0.3);
    const Eigen::VectorXd x = RandomStream(1, 0, 0).normals(20), y = RandomStream(1, 0, 1).normals(20);
    EXPECT_LT((field.whitened(field.coloured(x)) - x).norm(), 1e-12);  // rounding
    EXPECT_NEAR(field.coloured(x).col(0).dot(y), x.dot(field.transposed(y).col(0)), 1e-12);
    EXPECT_NEAR(field.log_root(), std::log(std::abs(root(field, 20).determinant())), 1e-12);
}

TEST(Neighbours, WeightsAddUpToOneAtEachEndOfALink) {
    const skeleton::Model model = make_lattice({4, 3, 2});
    const Parameters parameters = group_stiffness(model, Scope::links);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(parameters.size());
    for (const auto& [a, b, weight] : neighbours(model, parameters)) {
        EXPECT_EQ(parameters.list[a].kind, parameters.list[b].kind);
        sum[a] += weight;
        sum[b] += weight;
    }
    EXPECT_NEAR(sum.minCoeff(), 2, 1e-12);  // every sphere of the lattice has several links
    EXPECT_NEAR(sum.maxCoeff(), 2, 1e-12);
}

TEST(Neighbours, LinksThatNothingTellsAboutFollowThem) {
    // a chain whose far part is soft, pushed at the eighth of its eleven free spheres: the rest just comes along
    constexpr int pushed = 8;
    const skeleton::Model model = with_law(make_lattice({12, 1, 1}), skeleton::EquilibriumLaw::linear);
    skeleton::Model truth = model;
    for (int l = 4; l < 11; ++l) truth.links[l].stiffness *= 0.4;
    std::vector<LoadState> states(2);
    for (int s = 0; s < 2; ++s) {
        states[s].probe = s + 1;
        states[s].contacts.push_back({model.spheres[pushed].center, s == 0 ? Vec3(1, 0, 0) : Vec3(0, 0, 0.02), 0});
    }
    const MeasurementSet set = simulate_measurements(truth, states, markers_on_spheres(model), 1e-3, 5);
    IdentifyOptions options;
    options.law = LawChoice::linear;
    const Calibration calibration = calibrate(model, collect_readings(model, set), options, {});

    // a Markov chain: given the last link that is told, the others do not matter; variances are equal
    const Eigen::VectorXd off = calibration.fit.theta - calibration.prior.mean;
    const auto P = off.size();
    const Eigen::MatrixXd C = calibration.prior.field->coloured(Eigen::MatrixXd::Identity(P, P));
    for (const int kind : {0, 1}) {
        const int last = 3 * (pushed - 1) + kind;
        EXPECT_LT(off[last], -0.1);
        for (int l = pushed; l < 11; ++l) {
            const double correlation = C.row(last).dot(C.row(3 * l + kind));
            EXPECT_GT(correlation, 0.02);
            EXPECT_NEAR(off[3 * l + kind], correlation * off[last], 1e-2 * std::abs(off[last]));  // the fit's tolerance
        }
    }
}

}  // namespace
}  // namespace palpate::identify
