#include "fem/effects/local/stiffness_map.h"

#include <cmath>
#include <map>

#include "identify/effects/body/material/stiffness_parts.h"
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

TEST_F(TwoLumps, AreTwoInclusions) {
    const Diagnosis found = diagnose(lumpy(), options());
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_THAT(found.explanation, ElementsAre("inclusion", "inclusion"));
    // Each has a row of its own, with its own numbers.
    std::vector<Vec3> centres;
    std::vector<double> ratios;
    for (const Candidate& row : found.ranking) {
        if (row.effect->name() != "inclusion") continue;
        centres.emplace_back(estimate(row, "cx"), estimate(row, "cy"), estimate(row, "cz"));
        ratios.push_back(estimate(row, "ratio"));
    }
    ASSERT_EQ(centres.size(), 2);
    const std::size_t stiff = ratios[0] > ratios[1] ? 0 : 1;
    EXPECT_LT((centres[stiff] - stiff_at).norm(), 6);  // within the radius of each
    EXPECT_LT((centres[1 - stiff] - soft_at).norm(), 6);
    EXPECT_GT(ratios[stiff], 2);
    EXPECT_LT(ratios[1 - stiff], 0.6);
}

TEST_F(TwoLumps, AreTheMapThatExplainsThem) {
    DiagnoseOptions without = options();
    without.without = {"inclusion"};
    const Diagnosis found = diagnose(lumpy(), without);
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
    without.without = {"map", "inclusion"};
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

/// Four places along x, 20 mm apart: four lengths, so that they hardly know of each other.
skeleton::EffectRecord four_places(const std::vector<double>& amplitudes) {
    skeleton::EffectRecord record{"map", {{"length", 5, "mm"}}};
    for (int i = 0; i < 4; ++i) {
        record.parameters.push_back({"x" + std::to_string(i + 1), 20.0 * i, "mm"});
        record.parameters.push_back({"y" + std::to_string(i + 1), 0, "mm"});
        record.parameters.push_back({"z" + std::to_string(i + 1), 0, "mm"});
        record.parameters.push_back({"a" + std::to_string(i + 1), amplitudes[static_cast<std::size_t>(i)], "1"});
    }
    return record;
}

TEST(StiffnessMapEffect, TellsTheElementsOfEachPart) {
    const mesh::VolumeMesh bar = mesh::make_bar(Vec3(-10, -5, -5), Vec3(70, 5, 5), {32, 4, 4});
    const std::vector<int> part_of = StiffnessEstimate(four_places({1.2, 0, 0, -1.2})).part_of_elements(bar);
    ASSERT_EQ(std::ssize(part_of), bar.tetrahedra.rows());
    for (Eigen::Index e = 0; e < bar.tetrahedra.rows(); ++e) {
        double x = 0;
        for (int corner = 0; corner < 4; ++corner) x += bar.nodes(bar.tetrahedra(e, corner), 0) / 4;
        // k1 / sqrt(k1^2 + k2^2) = 1/2 where k2 / k1 = sqrt(3): at exp((x^2 - (20 - x)^2) / 50).
        const double border = 10 + 50 * std::log(3) / 80;
        EXPECT_EQ(part_of[static_cast<std::size_t>(e)], x <= border ? 0 : x >= 60 - border ? 1 : -1) << x;
    }
}

TEST(StiffnessMapEffect, HasNoElementsWhereNothingStandsOut) {
    const mesh::VolumeMesh bar = mesh::make_bar(Vec3(-10, -5, -5), Vec3(70, 5, 5), {8, 1, 1});
    EXPECT_THAT(StiffnessEstimate(four_places({0.1, 0, 0, -0.1})).part_of_elements(bar), testing::Each(-1));
}

TEST(StiffnessMapEffect, TellsPartsThatDifferByMoreThanIsKnown) {
    const auto map = find_effect("map");
    const skeleton::EffectRecord record = four_places({1.2, 0, 0, -1.2});
    // Places four lengths apart hardly know of each other: e^1.2 = 3.32, and its inverse.
    EXPECT_EQ(map->sentence(record),
              "Stiffness varies over the body, over lengths of about 5 mm: 3.32 times its mean round (0, 0, 0) mm, "
              "0.301 times its mean round (60, 0, 0) mm.");
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(17, 17);
    covariance(0, 0) = 1;
    for (const Eigen::Index a : {4, 8, 12, 16}) covariance(a, a) = 1;
    EXPECT_EQ(
        map->sentence_with(record, covariance),
        "Stiffness varies over the body, over lengths of about 5.0 ± 1.0 mm, nowhere by more than is known of it.");
}

}  // namespace
}  // namespace palpate::identify
