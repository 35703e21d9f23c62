#include "identify/diagnosis/fit/tangent_cache.h"

#include <gtest/gtest.h>

#include "identify/diagnosis/fit/refit.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

struct Sized final : Tangent {
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override { return B; }
    double gigabytes() const override { return 0.1; }
};

TEST(TangentCache, AreMadeOnceWhereThereIsRoom) {
    TangentCache tangents(4, 0.25);
    int made = 0;
    const auto make = [&] {
        ++made;
        return std::make_shared<const Sized>();
    };
    // the first two are, in whatever order they are asked for
    for (int round = 0; round < 2; ++round) {
        for (const int action : {3, 2, 1, 0}) EXPECT_NE(tangents.get(action, make), nullptr);
    }
    EXPECT_EQ(made, 4 + 2);
    EXPECT_NE(tangents.kept(0), nullptr);
    EXPECT_EQ(tangents.kept(1), tangents.get(1, make).get());
    EXPECT_EQ(tangents.kept(2), nullptr);
    EXPECT_EQ(tangents.kept(3), nullptr);
}

class Guided : public testing::TestWithParam<bool> {};

TEST_P(Guided, PlaysComeToTheSame) {
    const SmallBody body;
    std::unique_ptr<BodyModel> model;
    if (GetParam()) {
        model = body.skeleton();
    } else {
        model = body.reference();
    }
    for (int law = 0; law < static_cast<int>(model->laws().size()); ++law) {
        Explanation truth = bare_truth(*model, law);
        MeasurementSet set = body.set(SmallBody::probes(0.03, 4));
        set.material = MaterialGuess{.poisson = 0.45};
        const Problem problem = make_problem(make_twin(*model, set, truth, 0), 0.05);
        const ForwardSolution at = solve_forward(*model, problem, truth, 1);
        sensitivities(*model, problem, truth, at, {own_signatures(*model, problem, truth, at)}, 1);
        if (model->is_nonlinear(truth.setting())) {
            EXPECT_NE(at.tangents->kept(1), nullptr);
        }

        truth.theta.array() += 0.1;
        const ForwardSolution alone = solve_forward(*model, problem, truth, 1, &at.q);
        const ForwardSolution guided = solve_forward(*model, problem, truth, 1, &at.q, at.tangents.get());
        for (std::size_t k = 1; k < alone.q.size(); ++k) {  // nothing acts in the first
            const double moved = (alone.markers[k] - problem.rest).norm();
            EXPECT_LT((guided.markers[k] - alone.markers[k]).norm(), 1e-6 * moved) << model->laws()[law];
        }
    }
}

INSTANTIATE_TEST_SUITE_P(ByModels, Guided, testing::Bool(),
                         [](const auto& test) { return test.param ? "skeleton" : "reference"; });

}  // namespace
}  // namespace palpate::identify
