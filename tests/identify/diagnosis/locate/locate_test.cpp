#include "identify/diagnosis/locate/locate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/locate/reading_adjoints.h"
#include "identify/diagnosis/locate/sources/source_evidence.h"
#include "identify/effects/catalogue.h"
#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

/// What is hidden in the bar, and what has to be found without a name for it.
struct LocatedCase {
    std::string effect;
    Eigen::VectorXd values;  // the fit's numbers
    double force;            // of the probes, as a multiple of their own [N]
    SourceKind kind;
    SourceLaw law;
};

class Located : public testing::TestWithParam<LocatedCase> {
protected:
    Located() : set_(body_.set(SmallBody::probes(GetParam().force))) {
        Explanation truth = bare_truth(*model_, neo_hookean);
        if (!GetParam().effect.empty()) truth = with(truth, find_effect(GetParam().effect), GetParam().values);
        set_ = make_twin(*model_, set_, truth, sigma);
        DiagnoseOptions options;
        options.law = neo_hookean;
        options.refit.nuisances.ragged = 0;
        options.screen = false;
        found_ = diagnose(*model_, set_, options);
        source_ = locate_missing(*model_, found_.problem, found_.baseline, 1);
    }

    SmallBody body_;
    std::unique_ptr<ReferenceBody> model_ = body_.reference();
    MeasurementSet set_;
    Diagnosis found_;
    std::optional<MissingSource> source_;
};

TEST_P(Located, IsOfItsKindAndGoesByItsLaw) {
    ASSERT_TRUE(source_);
    EXPECT_EQ(source_->kind, GetParam().kind) << source_->sentence();
    EXPECT_EQ(source_->likeliest().law, GetParam().law) << source_->sentence();
    EXPECT_GT(source_->log_bayes_factor(), DiagnoseOptions{}.least_evidence());
    EXPECT_FALSE(source_->states.empty());
    EXPECT_GT(source_->explained, 0.3);
    double sum = 0;
    for (const SourceTerm& term : source_->terms) sum += term.probability;
    EXPECT_NEAR(sum, 1, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Effects, Located,
                         testing::Values(LocatedCase{"gravity", numbers({0, 0.2, -0.3}), 0.03, SourceKind::body_force,
                                                     SourceLaw::constant},
                                         LocatedCase{"inclusion", numbers({27, 5, 5, std::log(6.7), std::log(4)}), 0.1,
                                                     SourceKind::stiffness, SourceLaw::constant},
                                         LocatedCase{"anisotropy", numbers({1.5, 0.48, 0.6, 0.64}), 0.2,
                                                     SourceKind::stiffness, SourceLaw::constant},
                                         LocatedCase{"contact", numbers({0, 0, 1, -2, std::log(0.5)}), 0.1,
                                                     SourceKind::boundary, SourceLaw::one_sided},
                                         LocatedCase{"misalignment", numbers({1, -1, 1, 0.3, -0.3, 0.3}), 0.03,
                                                     SourceKind::sensor, SourceLaw::constant}),
                         [](const auto& of) { return of.param.effect; });

using LocatedBall = Located;
TEST_P(LocatedBall, IsWhereItLies) {
    ASSERT_TRUE(source_);
    const Vec3 centre = GetParam().values.head<3>();
    // Fifteen hundredths of the size; the bar is 40 mm long.
    EXPECT_LT((source_->at - centre).norm(), 0.15 * model_->size());
    // Stiffer there than elsewhere: its field shows it.
    Points places(2, 3);
    places << 22, 5, 5, 38, 5, 5;
    const SourceField field = field_of(*source_, places, 1);
    EXPECT_GT(field.mean(0, 0), 0);
    EXPECT_LT(std::abs(field.mean(1, 0)), field.mean(0, 0));
}
INSTANTIATE_TEST_SUITE_P(Effects, LocatedBall,
                         // Half as stiff again: what stiffens far more is, to first order, as if the root were softer.
                         testing::Values(LocatedCase{"inclusion", numbers({22, 5, 5, std::log(6.7), std::log(1.5)}),
                                                     0.15, SourceKind::stiffness, SourceLaw::constant}));

using LocatedWeight = Located;
TEST_P(LocatedWeight, PointsWhereItPulls) {
    ASSERT_TRUE(source_);
    const Vec3 g = GetParam().values.head<3>();
    constexpr double degrees = M_PI / 180;
    EXPECT_LT(std::acos(source_->direction.dot(g.normalized())), 20 * degrees) << source_->sentence();
    EXPECT_EQ(std::ssize(source_->states), std::ssize(set_.states));
}
INSTANTIATE_TEST_SUITE_P(Effects, LocatedWeight,
                         testing::Values(LocatedCase{"gravity", numbers({0, 0.2, -0.3}), 0.03, SourceKind::body_force,
                                                     SourceLaw::constant}));

/// A wall of a direction that no side of the bar has.
using LocatedWall = Located;
TEST_P(LocatedWall, PushesBackAlongItsNormalBehindItsGap) {
    ASSERT_TRUE(source_);
    const Vec3 normal = GetParam().values.head<3>().normalized();
    constexpr double degrees = M_PI / 180;
    EXPECT_LT(std::acos(source_->direction.dot(normal)), 20 * degrees) << source_->sentence();
    const SourceTerm& term = source_->likeliest();
    EXPECT_GT(term.gap, 0);
    EXPECT_LT(term.strength.minCoeff(), 0.01);  // away from it in some states
    EXPECT_NEAR(term.strength.maxCoeff(), 1, 1e-9);
    EXPECT_LT(std::ssize(source_->states), std::ssize(set_.states));
    EXPECT_THAT(source_->sentence(), testing::HasSubstr("once the body has moved outward by"));
}
INSTANTIATE_TEST_SUITE_P(Effects, LocatedWall,
                         testing::Values(LocatedCase{"contact", numbers({0, 0.6, 0.8, -2, std::log(0.5)}), 0.1,
                                                     SourceKind::boundary, SourceLaw::one_sided}));

/// Of all ways in which the stiffness of the whole body may go with what acts, a law of the material goes by its
/// strain. It stiffens little, as sources are sought to first order.
using LocatedStiffening = Located;
TEST_P(LocatedStiffening, GoesWithTheStrain) {
    ASSERT_TRUE(source_);
    const auto is_of_body = [](const MissingSource::Rival& one) {
        return one.term.form == SourceForm::softening && std::isinf(one.term.radius);
    };
    const auto likeliest = std::ranges::find_if(source_->rivals, is_of_body);  // they are in order
    ASSERT_NE(likeliest, source_->rivals.end());
    EXPECT_EQ(likeliest->term.law, SourceLaw::with_strain);
    EXPECT_GT(likeliest->term.mean[0], 0);
    const MissingSource alone{.kind = SourceKind::stiffness, .terms = {likeliest->term}};
    EXPECT_THAT(alone.sentence(), testing::HasSubstr("becomes stiffer as it is strained"));
}
INSTANTIATE_TEST_SUITE_P(Effects, LocatedStiffening,
                         testing::Values(LocatedCase{"stiffening", numbers({0.3, 2.3}), 0.15, SourceKind::stiffness,
                                                     SourceLaw::with_strain}));

using LocatedNothing = Located;
TEST_P(LocatedNothing, HasNoEvidence) {
    if (!source_) return;
    // Where nothing is missing a Bayes factor is 1 on average.
    EXPECT_LT(source_->log_bayes_factor(), DiagnoseOptions{}.least_evidence()) << source_->sentence();
}
INSTANTIATE_TEST_SUITE_P(Effects, LocatedNothing,
                         testing::Values(LocatedCase{"", {}, 0.1, SourceKind::sensor, SourceLaw::constant}));

/// A finger that touches the side in two states, of which the set says nothing.
TEST(LocatedTouch, IsInTheStatesThatItTouchesIn) {
    const SmallBody body;
    const auto model = body.reference();
    const MeasurementSet told = body.set(SmallBody::probes());
    MeasurementSet touched = told;
    const std::vector<int> states{3, 6};
    const Vec3 place(28, 5, 10), touch(0.003, 0.003, -0.02);  // [mm], [N]
    for (const int state : states) touched.states[state].contacts.push_back({place, touch, 3});
    MeasurementSet set = make_twin(*model, touched, bare_truth(*model, neo_hookean), 0.005);
    for (std::size_t s = 0; s < set.states.size(); ++s) set.states[s].contacts = told.states[s].contacts;
    DiagnoseOptions options;
    options.law = neo_hookean;
    options.refit.nuisances.ragged = 0;
    options.screen = false;
    const Diagnosis found = diagnose(*model, set, options);
    const auto source = locate_missing(*model, found.problem, found.baseline, 1);
    ASSERT_TRUE(source);
    EXPECT_EQ(source->kind, SourceKind::boundary) << source->sentence();
    EXPECT_EQ(source->likeliest().law, SourceLaw::some_states) << source->sentence();
    EXPECT_EQ(source->states, states);
    EXPECT_THAT(source->sentence(), testing::HasSubstr("alike in 2 of the "));
    constexpr double degrees = M_PI / 180;
    EXPECT_LT(std::acos(source->direction.dot(touch.normalized())), 20 * degrees) << source->sentence();
    EXPECT_LT((source->at - place).norm(), 2 * source->spread);
}

/// The same as by a solve for each force.
TEST(ReadingAdjoints, AnswerForcesAsSensitivitiesDo) {
    const SmallBody body;
    const auto model = body.reference();
    const Problem problem = make_problem(body.set(SmallBody::probes(0.03, 2)), 0.1);
    const Explanation explanation = bare_truth(*model, neo_hookean);
    const ForwardSolution forward = solve_forward(*model, problem, explanation, 1);
    const Signatures own = own_signatures(*model, problem, explanation, forward);
    const Eigen::MatrixXd expected = sensitivities(*model, problem, explanation, forward, {own}, 1).front();
    const std::vector<ReadingEntry> entries = reading_entries(problem);
    ASSERT_EQ(std::ssize(entries), problem.rows());
    Eigen::MatrixXd felt = Eigen::MatrixXd::Zero(problem.rows(), own.width);
    for_each_adjoint(*model, problem, explanation, forward, entries, 1, [&](const ActionAdjoint& adjoint) {
        const Signatures::InAction part = own.in_action(adjoint.action, forward.q[adjoint.action]);
        if (part.columns.empty()) return;
        const Eigen::MatrixXd there = adjoint.felt(part.forces);
        for (Eigen::Index e = 0; e < adjoint.count(); ++e)
            felt(entries[adjoint.first + e].row, part.columns) = there.row(e);
    });
    EXPECT_LT((felt - expected).norm(), 1e-8 * expected.norm());  // of factors whose condition is some 1e6
}

TEST(SourceScore, IsOneOnAverageWhereNothingIsMissing) {
    constexpr int rows = 60, states = 5, draws = 4000;
    RandomStream random(3, 0, 0);
    const Eigen::VectorXd column = random.normals(rows);
    const Whitening V = noise_alone(rows);
    double mean = 0;
    for (int i = 0; i < draws; ++i) {
        const Eigen::VectorXd d = random.normals(rows);
        mean += std::exp(SourceScore(V, d, states)(column, 1).front().log_bayes_factor) / draws;
    }
    // Its size is known here: the error of the mean of a heavy-tailed factor is about a tenth. Below the noise chi^2
    // counts in full, above it for less.
    EXPECT_LT(mean, 1.2);
    EXPECT_GT(mean, 0.3);
}

TEST(SourceScore, FindsTheSizeOfWhatIsThere) {
    constexpr int rows = 60, states = 5;
    RandomStream random(4, 0, 0);
    const Eigen::MatrixXd columns = Eigen::MatrixXd(random.normals(rows * 2).reshaped(rows, 2));
    const Eigen::Vector2d truth(3, -2);
    const Eigen::VectorXd d = columns * truth + random.normals(rows);
    const SourceEvidence found = SourceScore(noise_alone(rows), d, states)(columns, 2).front();
    for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(found.mean[i], truth[i], 4 * std::sqrt(found.covariance(i, i)) + 0.02 * std::abs(truth[i]));
    EXPECT_GT(found.log_bayes_factor, DiagnoseOptions{}.least_evidence());
}

TEST(MissingSource, SaysOfAStiffnessWhatAFirstOrderModelCanTell) {
    MissingSource source{.kind = SourceKind::stiffness, .at = Vec3(1, 2, 3), .spread = 4};
    SourceTerm term{.form = SourceForm::softening, .radius = 5};
    const auto sentence_of = [&](double ln_stiffness) {
        term.mean = Eigen::VectorXd::Constant(1, ln_stiffness);
        term.sd = Eigen::VectorXd::Constant(1, 0.1);
        source.terms = {term};
        return source.sentence();
    };
    EXPECT_THAT(sentence_of(std::log(2.0)), testing::HasSubstr("2 times as stiff (from 1.6 to 2.4) around (1.0, 2.0"));
    EXPECT_THAT(sentence_of(-50), testing::HasSubstr("softer by more than five times"));
    EXPECT_THAT(sentence_of(3), testing::HasSubstr("stiffer by more than five times"));
}

}  // namespace
}  // namespace palpate::identify
