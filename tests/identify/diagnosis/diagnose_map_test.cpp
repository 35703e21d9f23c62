#include "fem/effects/local/stiffness_map.h"

#include <cmath>
#include <map>

#include "tests/identify/diagnosed.h"

// Stiffness that differs in several parts of the body: asked where no other effect explains the readings.

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::Not;

constexpr double fine = 0.004;  // [mm]
const Vec3 stiff_at(34, 5, 5), soft_at(20, 5, 5);

/// Two lumps, which one ball cannot be: six times as stiff round one place, a third as stiff round another.
class TwoLumps : public Diagnosed {
protected:
    MeasurementSet lumpy() const {
        const auto ball = find_effect("inclusion");
        Explanation hidden = with(truth(), ball, numbers({34, 5, 5, std::log(6), std::log(6)}));
        hidden = with(hidden, ball, numbers({20, 5, 5, std::log(6), std::log(1 / 3.0)}));
        return make_twin(*model_, body_.set(SmallBody::probes(0.05, 16)), hidden, fine);
    }
    static DiagnoseOptions options() {
        DiagnoseOptions result;
        result.law = neo_hookean;
        result.refit.nuisances.ragged = 0;  // the readings come from this very mesh
        return result;
    }
    static fem::StiffnessMap map_of(const skeleton::EffectRecord& record) {
        std::map<std::string, double> values;
        for (const auto& p : record.parameters) values[p.name] = p.value;
        return fem::stiffness_map(fem::EffectNumbers(values));
    }
};

TEST_F(TwoLumps, AreTheMapThatExplainsThem) {
    const Diagnosis found = diagnose(lumpy(), options());
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_THAT(found.explanation, ElementsAre("map"));
    const Candidate& map = candidate(found, "map");
    // Balls with a border, told by kernels of the distance between places: peaks are flattened.
    const fem::StiffnessMap told = map_of(map.estimate.effect);
    EXPECT_GT(told.stiffness(stiff_at), 1.8);
    EXPECT_LT(told.stiffness(soft_at), 0.7);
    const std::string sentence = map.effect->sentence_with(map.estimate.effect, map.estimate.covariance);
    EXPECT_THAT(sentence, HasSubstr("Stiffness varies over the body"));
    EXPECT_THAT(sentence, HasSubstr("times its mean round"));
    EXPECT_LT(map.held_out->rms_mm, 0.5 * found.baseline_held_out.rms_mm);
}

TEST_F(TwoLumps, LeftOutOfTheCatalogueTheyAreUnexplained) {
    DiagnoseOptions without = options();
    without.without = {"map"};
    const Diagnosis found = diagnose(lumpy(), without);
    EXPECT_THAT(found.explanation, Not(Contains("map")));
    EXPECT_EQ(found.verdict, Verdict::unexplained);
}

TEST_F(TwoLumps, AreNotLookedForWhereAForceIsMissing) {
    DiagnoseOptions without = options();
    without.without = {"gravity", "prestress", "swelling", "misalignment"};
    const Diagnosis found = diagnose(twin(truth("gravity", half_g)), without);
    EXPECT_EQ(found.verdict, Verdict::unexplained);
    for (const Candidate& one : found.ranking) EXPECT_NE(one.effect->name(), "map");
}

TEST_F(TwoLumps, OneLumpIsAnInclusion) {
    const Eigen::VectorXd ball = numbers({27, 5, 5, std::log(6.7), std::log(4)});
    const Diagnosis found = diagnose(twin(truth("inclusion", ball), fine), options());
    EXPECT_THAT(found.explanation, ElementsAre("inclusion"));
    for (const Candidate& one : found.ranking) EXPECT_NE(one.effect->name(), "map");
}

TEST(StiffnessMapEffect, KnowsTheSlopesOfItsField) {
    SmallBody body;
    // Pieces enough for slopes of pieces, of which a bar of five cells has none.
    EXPECT_FALSE(find_effect("map")->piece_slopes(*body.reference(), Eigen::VectorXd::Zero(161)));
    body.mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), {14, 4, 4}));
    const auto model = body.reference();
    const auto map = find_effect("map");
    const auto numbers = map->numbers(*model, make_problem(body.set(SmallBody::probes()), 1));
    const Eigen::VectorXd values = example(*map, numbers);
    const auto at = [&](const Eigen::VectorXd& x) {
        ModelSetting setting;
        map->enforce(x, setting);
        Eigen::VectorXd of_pieces(model->pieces().rows());
        for (Eigen::Index p = 0; p < of_pieces.size(); ++p)
            of_pieces[p] = std::log(setting.effects.material[0]->stiffness(model->pieces().row(p)));
        return of_pieces;
    };
    const Eigen::MatrixXd slopes = map->piece_slopes(*model, values).value();
    constexpr double h = 1e-5;  // truncation h^2, rounding 1e-16 / h
    for (Eigen::Index j = 0; j < values.size(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(values.size(), j);
        const Eigen::VectorXd expected = (at(values + step) - at(values - step)) / (2 * h);
        if (!map->is_fitted(j)) {
            EXPECT_TRUE(slopes.col(j).isZero(0));
            continue;
        }
        EXPECT_LT((slopes.col(j) - expected).cwiseAbs().maxCoeff(), 1e-7) << numbers[static_cast<std::size_t>(j)].name;
    }
}

TEST(StiffnessMapEffect, TellsPartsThatDifferByMoreThanIsKnown) {
    const auto map = find_effect("map");
    skeleton::EffectRecord record{"map", {{"length", 5, "mm"}}};
    const std::vector<double> amplitudes{1.2, 0, 0, -1.2};
    for (int i = 0; i < 4; ++i) {
        record.parameters.push_back({"x" + std::to_string(i + 1), 20.0 * i, "mm"});
        record.parameters.push_back({"y" + std::to_string(i + 1), 0, "mm"});
        record.parameters.push_back({"z" + std::to_string(i + 1), 0, "mm"});
        record.parameters.push_back({"a" + std::to_string(i + 1), amplitudes[static_cast<std::size_t>(i)], "1"});
    }
    // Places four lengths apart hardly know of each other: e^1.2 = 3.32, and its inverse.
    EXPECT_EQ(map->sentence(record),
              "Stiffness varies over the body, over lengths of about 5 mm: (3.32) times its mean round (0, 0, 0) mm, "
              "(0.301) times its mean round (60, 0, 0) mm.");
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(17, 17);
    covariance(0, 0) = 1;
    for (const Eigen::Index a : {4, 8, 12, 16}) covariance(a, a) = 1;
    EXPECT_EQ(
        map->sentence_with(record, covariance),
        "Stiffness varies over the body, over lengths of about 5.0 ± 1.0 mm, nowhere by more than is known of it.");
}

}  // namespace
}  // namespace palpate::identify
