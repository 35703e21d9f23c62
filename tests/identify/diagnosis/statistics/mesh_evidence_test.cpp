#include "identify/diagnosis/statistics/mesh_evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"
#include "identify/numerics/random.h"

// How much evidence errors of a mesh lend to an effect.

namespace palpate::identify {
namespace {

/// Three numbers of an effect beside two of the body, told by 80 readings under 4 probes, with 3 nuisances.
class MeshEvidence : public testing::Test {
protected:
    static constexpr int probes = 4, rows = 80, of_body = 2, of_effect = 3, nuisances = 3;

    MeshEvidence() {
        RandomStream random(11, 0, 0);
        problem_.measured.setZero(rows);
        problem_.sigma.setConstant(rows, 0.5);
        problem_.discretisation = random.normals(rows);
        for (int p = 0; p < probes; ++p) problem_.probe.push_back(p + 1);
        for (int n = 0; n < rows; ++n) problem_.action.push_back(n / (rows / probes));
        Refit& fit = explained_.fit;
        explained_.effects = fit.explanation.effects = {find_effect("stiffening")};
        fit.explanation.theta.setZero(of_body);
        fit.explanation.values = {Eigen::VectorXd::Zero(of_effect)};
        fit.columns = drawn(random, of_body + of_effect);
        fit.prior_sd.setConstant(of_body + of_effect, 3);
        fit.nuisances.columns = drawn(random, nuisances);
        fit.nuisances.precisions.setConstant(nuisances, 4);
        fit.V.emplace(Eigen::VectorXd::Constant(rows, 0.9), fit.nuisances.columns, fit.nuisances.precisions);
    }

    static Eigen::MatrixXd drawn(RandomStream& random, int columns) {
        Eigen::MatrixXd result(rows, columns);
        for (int c = 0; c < columns; ++c) result.col(c) = random.normals(rows);
        return result;
    }

    /// Half of the squares by which the effect lowers the misfit of an error, the body's numbers free beside it.
    double gain(const Eigen::VectorXd& error) const {
        const Refit& fit = explained_.fit;
        Eigen::MatrixXd unknown(rows, nuisances + of_body);
        unknown << fit.nuisances.columns, fit.columns.leftCols(of_body);
        Eigen::VectorXd precisions(nuisances + of_body);
        precisions << fit.nuisances.precisions, Eigen::VectorXd::Constant(of_body, 1.0 / 9);
        const Whitening V(fit.V->weights(), unknown, precisions);
        const Eigen::MatrixXd S = fit.columns.rightCols(of_effect);
        const Eigen::VectorXd value = screen(V, error, S, fit.prior_sd.tail(of_effect)).value;
        return 0.5 * (S * value).dot(V.apply(error).col(0));
    }

    Problem problem_;
    FittedExplanation explained_;
};

TEST_F(MeshEvidence, IsExceededNoOftenerThanStated) {
    constexpr double probability = 0.05, share = 0.7;
    const double bound = evidence_of_mesh_error(problem_, explained_, share, -std::log(probability));
    constexpr int draws = 4000;
    int above = 0, above_a_third = 0;
    for (int i = 0; i < draws; ++i) {
        const Eigen::VectorXd amplitude = share * RandomStream(12, 0, static_cast<std::uint64_t>(i)).normals(probes);
        Eigen::VectorXd error(rows);
        for (int n = 0; n < rows; ++n)
            error[n] = amplitude[problem_.action[n]] * problem_.discretisation[n] / problem_.sigma[n];
        above += gain(error) > bound ? 1 : 0;
        above_a_third += gain(error) > bound / 3 ? 1 : 0;
    }
    EXPECT_LE(above, probability * draws);
    // For three equal squares the bound is 15.4 where the quantile is 7.8; sums of others are nearer, or twice as far.
    EXPECT_GE(above_a_third, probability * draws);
}

TEST_F(MeshEvidence, IsNoneOfWhatTheBodyTakesUp) {
    const double any = evidence_of_mesh_error(problem_, explained_, 1, 7);
    // in each probe what the first number of the body does there, alike in all
    problem_.discretisation = explained_.fit.columns.col(0).cwiseProduct(problem_.sigma);
    problem_.probe.assign(problem_.probe.size(), 1);
    // a prior of three sigmas next to 80 readings: a share of 1 / (80 * 9) is not taken up
    EXPECT_LT(evidence_of_mesh_error(problem_, explained_, 1, 7), 1e-3 * any);
    problem_.discretisation.resize(0);
    EXPECT_EQ(evidence_of_mesh_error(problem_, explained_, 1, 7), 0);
}

TEST_F(MeshEvidence, OfAnEffectThatWasThereBeforeIsNone) {
    // Three numbers are added to two; or two, to an effect of one number that was there, or to a body of three.
    const double three = evidence_of_mesh_error(problem_, explained_, 1, 7);
    Explanation& all = explained_.fit.explanation;
    all.effects.insert(all.effects.begin(), find_effect("gravity"));
    all.values = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(of_effect - 1)};
    const double beside_effect = evidence_of_mesh_error(problem_, explained_, 1, 7);
    all.effects.erase(all.effects.begin());
    all.values.erase(all.values.begin());
    all.theta.setZero(of_body + 1);
    EXPECT_EQ(beside_effect, evidence_of_mesh_error(problem_, explained_, 1, 7));
    EXPECT_LT(beside_effect, three);
}

TEST_F(MeshEvidence, GrowsWithTheSquareOfTheError) {
    const double one = evidence_of_mesh_error(problem_, explained_, 1, 7);
    EXPECT_NEAR(evidence_of_mesh_error(problem_, explained_, 0.5, 7), one / 4, 1e-12 * one);
    problem_.discretisation *= 3;
    EXPECT_NEAR(evidence_of_mesh_error(problem_, explained_, 1, 7), 9 * one, 1e-12 * 9 * one);
}

}  // namespace
}  // namespace palpate::identify
