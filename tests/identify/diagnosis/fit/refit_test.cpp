#include "identify/diagnosis/fit/refit.h"

#include <map>

#include "identify/diagnosis/fit/nearby.h"
#include "identify/diagnosis/likelihood/reading_weights.h"
#include "identify/diagnosis/search/baselines.h"
#include "tests/identify/diagnosed.h"

// Fits that begin at others.

namespace palpate::identify {
namespace {

class Refits : public Diagnosed {
protected:
    static double young(const Refit& fit) { return fit.explanation.theta[0]; }
    RefitOptions options_;
};

TEST_F(Refits, CarriedToAnotherLawComeOutAsFromAGuess) {
    // The skeleton's configurations under one law say nothing under another.
    const auto skeleton = body_.skeleton();
    const MeasurementSet set = make_twin(*skeleton, body_.set(SmallBody::probes()), bare_truth(*skeleton, 1), sigma, 1);
    const Problem problem = make_problem(set, sigma);
    const Refit linear = refit(*skeleton, problem, first_guess(*skeleton, problem, 0, 1), options_);
    Explanation carried = linear.explanation;
    carried.law = 1;
    const Refit from_linear = refit(*skeleton, problem, carried, options_, &linear);
    const Refit from_guess = refit(*skeleton, problem, first_guess(*skeleton, problem, 1, 1), options_);
    // Nuisances are taken on the way, from where the first round led.
    EXPECT_NEAR(young(from_linear), young(from_guess), std::sqrt(from_guess.covariance(0, 0)));
    EXPECT_NEAR(from_linear.log_evidence, from_guess.log_evidence, 5);
    EXPECT_EQ(from_linear.forward.q.front().size(), from_guess.forward.q.front().size());
    EXPECT_NE(from_linear.forward.q.front().size(), linear.forward.q.front().size());
}

TEST_F(Refits, OfAPartBeginAtTheWhole) {
    const MeasurementSet set = twin(truth("gravity", half_g));
    MeasurementSet part = set;
    std::erase_if(part.states, [](const LoadState& state) { return state.probe % 4 == 3; });
    const Problem all = make_problem(set, sigma), some = make_problem(part, sigma);
    const Explanation guess = with(first_guess(*model_, all, neo_hookean, 1), find_effect("gravity"), half_g);
    const Refit whole = refit(*model_, all, guess, options_);

    const auto start = start_at({&all, &whole}, some);
    ASSERT_TRUE(start);
    EXPECT_EQ(start->forward.q.size(), some.actions.size());
    const Refit near = refit(*model_, some, whole.explanation, options_, &*start);
    const Refit anew = refit(*model_, some, guess, options_);
    EXPECT_NEAR(young(near), young(anew), 0.1 * std::sqrt(anew.covariance(0, 0)));
    EXPECT_NEAR(near.log_evidence, anew.log_evidence, 2);  // nuisances are taken on the way
    EXPECT_LE(near.steps, anew.steps);

    EXPECT_FALSE(start_at({&some, &near}, all));  // it has not seen them all
}

TEST_F(Refits, KeepPoissonsRatioWhereMaterialsAre) {
    // A frame that is far off asks for any ratio.
    const Eigen::VectorXd moved = numbers({3, -2, 1, 0.1, -0.15, 0.2});
    const Problem problem = make_problem(twin(truth("misalignment", moved)), sigma);
    const StiffnessParameter& ratio = model_->parameters()[1];
    const Refit without = refit(*model_, problem, first_guess(*model_, problem, 0, 1), options_);
    EXPECT_GE(without.explanation.theta[1], ratio.least);
    EXPECT_LE(without.explanation.theta[1], ratio.most);

    // From a bound the way back is free.
    Explanation explanation = with(without.explanation, find_effect("misalignment"), 0 * moved);
    explanation.law = neo_hookean;
    explanation.theta[1] = ratio.most;
    const Refit found = refit(*model_, problem, explanation, options_);
    EXPECT_LT(found.whitened_rms, 1.1);
    EXPECT_NEAR(found.explanation.theta[1], truth().theta[1], 5 * std::sqrt(found.covariance(1, 1)));
}

TEST_F(Refits, PromiseWhatAnotherLawWouldDo) {
    constexpr int svk = 1;
    const MeasurementSet set = make_twin(*model_, body_.set(SmallBody::probes(0.1)), truth(svk), sigma);
    const Problem problem = make_problem(set, sigma);
    const Refit fit = refit(*model_, problem, first_guess(*model_, problem, neo_hookean, 1), options_);
    const double own = objective(fit);
    // Under its own law there is nothing left to mend.
    EXPECT_NEAR(promised_objective(*model_, problem, fit.explanation, options_, fit), own, 1);

    Explanation other = fit.explanation;
    other.law = svk;
    const double promised = promised_objective(*model_, problem, other, options_, fit);
    Refit start = fit;
    start.V.reset();
    const Refit there = refit(*model_, problem, other, options_, &start);
    EXPECT_LT(objective(there), own - 100);
    EXPECT_LT(promised, own - 100);  // by other nuisances, and slopes of the other law
    EXPECT_GT(promised, objective(there));
}

TEST_F(Refits, PromiseNothingWithoutEquilibria) {
    const Problem problem = make_problem(twin(truth()), sigma);
    const Refit fit = refit(*model_, problem, first_guess(*model_, problem, neo_hookean, 1), options_);
    Explanation soft = fit.explanation;
    soft.theta[0] -= 8;
    EXPECT_EQ(promised_objective(*model_, problem, soft, options_, fit), INFINITY);
}

TEST_F(Refits, NameTheNuisanceThatIsMostStrained) {
    // The clamp holds 8 mm more than it says.
    SmallBody other = body_;
    other.supports = {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(8.1, 11, 11)}};
    const auto held = other.reference();
    const Problem problem = make_problem(
        make_twin(*held, body_.set(SmallBody::probes()), bare_truth(*held, neo_hookean), 0.1 * sigma), 0.1 * sigma);
    const Refit fit = refit(*model_, problem, first_guess(*model_, problem, neo_hookean, 1), options_);
    EXPECT_GT(fit.nuisance_pull, 1);
    const auto at = std::ranges::find(fit.nuisances.names, fit.most_pulled_nuisance);
    ASSERT_NE(at, fit.nuisances.names.end());
    EXPECT_DOUBLE_EQ(std::abs(fit.V->nuisances(fit.error)[at - fit.nuisances.names.begin()]), fit.nuisance_pull);
}

TEST_F(Refits, TrustMarkersLessNextToWhatIsHeld) {
    const Problem problem = make_problem(twin(truth()), sigma);
    const NuisanceOptions border_alone{.dent = 0, .ragged = 0.15};
    const ForwardSolution forward = solve_forward(*model_, problem, truth(), 1);
    const Eigen::VectorXd weights = reading_weights(*model_, problem, truth(), forward, border_alone);
    Eigen::VectorXd unknown(24);  // sd beyond the noise, over what the marker moves
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int marker = problem.coordinate[n] / 3;
        const double moved = (forward.channels[problem.action[n]].row(marker) - problem.rest.row(marker)).norm();
        unknown[marker] = problem.sigma[n] * std::sqrt(std::pow(weights[n], -2) - 1) / moved;
    }
    EXPECT_GT(unknown.head(4).minCoeff(), 0.03);  // 6 mm from the support, of elements 8 mm long
    EXPECT_LT(unknown.maxCoeff(), 0.15);
    EXPECT_LT(unknown.segment(4, 4).maxCoeff(), unknown.head(4).minCoeff());
    EXPECT_LT(unknown.tail(16).maxCoeff(), 2e-3);
}

TEST_F(Refits, TrustMarkersLessWhereTheMaterialKeepsADent) {
    const MeasurementSet set = body_.set(SmallBody::releases(0.03, 2));
    const Problem problem = make_problem(set, sigma).stage_by_stage();
    const Explanation yields = truth("plasticity", numbers({std::log(0.05), std::log(0.3)}));
    const NuisanceOptions dents_alone{.dent = 30, .ragged = 0, .flow = 1e-9};
    const auto unknown_without_load = [&](const Explanation& explanation) {  // variance beyond the noise, by stage
        const Eigen::VectorXd weights = reading_weights(*model_, problem, explanation,
                                                        solve_forward(*model_, problem, explanation, 1), dents_alone);
        std::map<double, double> most;
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            const Stage& stage = problem.stages[problem.action[n]];
            if (!stage.action.contacts.empty()) continue;
            const double after = 10 * stage.probe + stage.time;
            most[after] = std::max(most[after], std::pow(weights[n], -2) - 1);
        }
        return most;
    };
    const std::map<double, double> elastic = unknown_without_load(truth()), kept = unknown_without_load(yields);
    ASSERT_EQ(kept.size(), 3);  // at first, and after either probe
    for (const auto& [after, variance] : elastic) EXPECT_LT(variance, 1e-9) << after;
    for (const auto& [after, variance] : kept) {
        EXPECT_EQ(variance > 0.01, after > 0) << after;
    }
}

TEST_F(Refits, TrustMarkersLessUnderAPressureBeyondYield) {
    const MeasurementSet set = body_.set(SmallBody::releases(0.03, 2));
    const Problem problem = make_problem(set, sigma).stage_by_stage();
    const auto loaded =
        std::ranges::find_if(problem.stages, [](const Stage& stage) { return !stage.action.contacts.empty(); });
    ASSERT_NE(loaded, problem.stages.end());
    const mesh::Contact& contact = loaded->action.contacts.front();
    const double r = effective_radius(*model_, contact);
    const double pressure = contact.force.norm() / (M_PI * r * r) / model_->young(truth().setting());
    constexpr double hardening = 0.3;
    const auto of_yield = [&](double yield) {
        return truth("plasticity", numbers({std::log(yield), std::log(hardening)}));
    };
    const ForwardSolution forward = solve_forward(*model_, problem, of_yield(10 * pressure), 1);
    const auto unknown = [&](double yield) {  // variance beyond the noise, under that load
        const NuisanceOptions dents_alone{.dent = 30, .ragged = 0, .flow = 0};
        const Eigen::VectorXd weights = reading_weights(*model_, problem, of_yield(yield), forward, dents_alone);
        double sum = 0;
        for (Eigen::Index n = 0; n < problem.rows(); ++n)
            if (problem.action[n] == loaded - problem.stages.begin()) sum += std::pow(weights[n], -2) - 1;
        return sum;
    };
    // An even pressure yields at 1.5 times the yield stress; at twice that it indents by 1/hardening more.
    EXPECT_NEAR(unknown(pressure / 1.5), unknown(10 * pressure), 1e-9 * unknown(10 * pressure));
    EXPECT_NEAR(unknown(pressure / 3) / unknown(10 * pressure), std::pow(1 + 1 / hardening, 2), 1e-6);
}

TEST_F(Refits, TrustMarkersLessNextToWhereAWallIsTouched) {
    // A wall beneath the tip.
    const Problem problem = make_problem(twin(truth()), sigma);
    const Explanation walled = truth("contact", numbers({0, 0, 1, -0.2, std::log(1.0)}));
    const ForwardSolution forward = solve_forward(*model_, problem, walled, 1);
    const auto unknown = [&](double wall_dent) {  // variance beyond the noise (N)
        const NuisanceOptions walls_alone{.dent = 0, .wall_dent = wall_dent, .ragged = 0};
        const Eigen::VectorXd weights = reading_weights(*model_, problem, walled, forward, walls_alone);
        return Eigen::VectorXd(weights.cwiseAbs2().cwiseInverse().array() - 1);
    };
    const Eigen::VectorXd all = unknown(1);
    EXPECT_EQ(unknown(0).cwiseAbs().maxCoeff(), 0);
    EXPECT_LT((unknown(0.5) - 0.25 * all).norm(), 1e-9 * all.norm());
    double near = 0, far = 0, apart = 0;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const Points skin = model_->skin_positions(forward.q[problem.action[n]], walled.setting());
        const Vec3 rest = problem.rest.row(problem.coordinate[n] / 3);
        if (skin.col(2).minCoeff() >= -0.2) {
            apart = std::max(apart, all[n]);
        } else if (rest.x() < 20) {
            far = std::max(far, all[n]);
        } else if (rest.x() > 30 && rest.z() < 1) {
            near = std::max(near, all[n]);
        }
    }
    EXPECT_EQ(apart, 0) << "where nothing touches";
    EXPECT_GT(near, 0);
    EXPECT_LT(far, 0.1 * near);
}

TEST_F(Refits, KnowLessWhereProbesDisagree) {
    // Noise alone scatters no more than the covariance says; of gains that come and go from probe to probe it knows
    // nothing.
    const Problem problem = make_problem(twin(truth()), sigma);
    Problem off = problem;
    for (Eigen::Index n = 0; n < off.rows(); ++n) {
        const double moved = off.measured[n] - off.rest(off.coordinate[n] / 3, off.coordinate[n] % 3);
        off.measured[n] += (off.probe[off.action[n]] % 2 ? 0.15 : -0.15) * moved;
    }
    const auto disagreement = [&](const Problem& with) {  // about ln E, over its standard deviation
        const Refit fit = refit(*model_, with, first_guess(*model_, with, neo_hookean, 1), options_);
        return std::sqrt(fit.scatter(0, 0) / fit.covariance(0, 0));
    };
    EXPECT_LT(disagreement(problem), 0.6);
    EXPECT_GT(disagreement(off), 1);
}

TEST_F(Refits, TrustReadingsLessWhereTheLoadHasCrept) {
    // The material gives way as under a greater load: so does what is unknown about a contact.
    const Explanation creeps = truth("viscosity", numbers({1, std::log(1)}));
    const MeasurementSet set = make_twin(*model_, body_.set(SmallBody::dwells(0.1)), creeps, sigma);
    const Problem problem = make_problem(set, sigma).stage_by_stage();
    const Eigen::VectorXd weights =
        reading_weights(*model_, problem, creeps, solve_forward(*model_, problem, creeps, 1), options_.nuisances);
    const auto unknown_at = [&](double time) {  // variance beyond the noise, at most
        double most = 0;
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            const Stage& stage = problem.stages[problem.action[n]];
            if (stage.time == time) most = std::max(most, std::pow(weights[n], -2) - 1);
        }
        return most;
    };
    EXPECT_GT(unknown_at(5), 2 * unknown_at(0.2));  // of (2.0 / 1.2)^2 and the pressure's share
}

}  // namespace
}  // namespace palpate::identify
