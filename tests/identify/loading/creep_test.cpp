#include "identify/loading/creep.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"
#include "tests/identify/small_body.h"

// What an elastic body has to bear to move as one that creeps, against Boltzmann's superposition written out.

namespace palpate::identify {
namespace {

constexpr fem::CreepLaw creep{.creep = 0.6, .tau = 4};
const mesh::Contact push{Vec3(1, 2, 3), Vec3(0.3, 0, -1), 2}, other{Vec3(9, 2, 3), Vec3(0, 1, 0), 2};

double J(double t) { return 1 + creep.creep * (1 - std::exp(-t / creep.tau)); }

mesh::Contact scaled(mesh::Contact contact, double factor) {
    contact.force *= factor;
    return contact;
}

/// The force at a contact's place.
Vec3 force_at(const std::vector<mesh::Contact>& load, const mesh::Contact& place) {
    Vec3 sum = Vec3::Zero();
    for (const mesh::Contact& contact : load) {
        if (contact.point == place.point) sum += contact.force;
    }
    return sum;
}

constexpr double creep_rounding = 1e-14;

TEST(CreptLoad, OfALoadThatIsHeldGrowsWithTheCompliance) {
    for (const double t : {0.0, 0.5, 4.0, 100.0}) {
        EXPECT_LT((force_at(creep_equivalent_load({{t, {push}}}, creep), push) - J(t) * push.force).norm(),
                  creep_rounding);
    }
    EXPECT_DOUBLE_EQ(J(1e6), 1.6);
    // however often it is read
    const std::vector<HeldLoad> often{{1, {push}}, {3, {push}}, {7, {push}}};
    EXPECT_LT((force_at(creep_equivalent_load(often, creep), push) - J(7) * push.force).norm(), creep_rounding);
}

TEST(CreptLoad, OfALoadThatWasTakenOffFades) {
    // on from 0 to 5, off since: J(t) - J(t - 5)
    for (const double t : {5.0, 6.0, 20.0}) {
        const Vec3 left = force_at(creep_equivalent_load({{5, {push}}, {t, {}}}, creep), push);
        EXPECT_LT((left - (J(t) - J(t - 5)) * push.force).norm(), creep_rounding) << t;
    }
    EXPECT_LT(force_at(creep_equivalent_load({{5, {push}}, {200, {}}}, creep), push).norm(), 1e-12);  // 50 tau
}

TEST(CreptLoad, OfTwoLevelsIsTheirSuperposition) {
    // F till 3, then 2 F: the first since 0, one more since 3
    const Vec3 load = force_at(creep_equivalent_load({{3, {push}}, {10, {scaled(push, 2)}}}, creep), push);
    EXPECT_LT((load - (J(10) + J(7)) * push.force).norm(), creep_rounding);
    // and back to none
    const Vec3 after = force_at(creep_equivalent_load({{3, {push}}, {10, {scaled(push, 2)}}, {12, {}}}, creep), push);
    EXPECT_LT((after - (J(12) + J(9) - 2 * J(2)) * push.force).norm(), creep_rounding);
}

TEST(CreptLoad, OfAForceThatStaysIsWhatTheWeightsAddUpTo) {
    const std::vector<double> weights = superposition_weights({1, 3, 7}, creep);
    ASSERT_EQ(weights.size(), 3u);
    EXPECT_NEAR(weights[0], J(7) - J(6), creep_rounding);
    EXPECT_NEAR(weights[2], J(4), creep_rounding);
    EXPECT_NEAR(weights[0] + weights[1] + weights[2], J(7), creep_rounding);
}

TEST(CreptLoad, OfTwoContactsIsThatOfEach) {
    const auto load = creep_equivalent_load({{3, {push, other}}, {10, {other}}}, creep);
    EXPECT_LT((force_at(load, push) - (J(10) - J(7)) * push.force).norm(), creep_rounding);
    EXPECT_LT((force_at(load, other) - J(10) * other.force).norm(), creep_rounding);
}

TEST(CreptLoad, WithoutCreepIsTheLoadItself) {
    const auto load = creep_equivalent_load({{3, {push}}, {10, {other}}}, {.creep = 0, .tau = 4});
    EXPECT_EQ(force_at(load, push).norm(), 0);
    EXPECT_EQ(force_at(load, other), other.force);
}

TEST(CreptLoad, OfASetBeginsAnewWithEachProbe) {
    MeasurementSet set;
    set.states = {LoadState{.probe = 1, .time = 3, .contacts = {push}}, LoadState{.probe = 1, .time = 10},
                  LoadState{.probe = 2, .time = 5, .contacts = {other}}};
    const MeasurementSet elastic = as_elastic(set, creep);
    ASSERT_EQ(elastic.states.size(), 3u);
    EXPECT_LT((force_at(elastic.states[0].contacts, push) - J(3) * push.force).norm(), creep_rounding);
    EXPECT_LT((force_at(elastic.states[1].contacts, push) - (J(10) - J(7)) * push.force).norm(), creep_rounding);
    EXPECT_EQ(force_at(elastic.states[2].contacts, push).norm(), 0);
    EXPECT_LT((force_at(elastic.states[2].contacts, other) - J(5) * other.force).norm(), creep_rounding);
}

TEST(CreepingBody, MovesAsAnElasticOneUnderTheLoadsThatItAmountsTo) {
    const SmallBody body;
    const auto model = body.reference();
    const Explanation bare = bare_truth(*model, 2);
    const MeasurementSet set = body.set(SmallBody::dwells(0.03, 3));
    const MeasurementSet creeping = make_twin(
        *model, set, with(bare, find_effect("viscosity"), Eigen::Vector2d(creep.creep, std::log(creep.tau))), 0);
    const MeasurementSet elastic = make_twin(*model, as_elastic(set, creep), bare, 0);
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        for (std::size_t r = 0; r < set.states[s].readings.size(); ++r) {
            // two equilibria, each to 1e-7 of its load
            EXPECT_LT((creeping.states[s].readings[r].position - elastic.states[s].readings[r].position).norm(), 1e-5);
        }
    }
}

}  // namespace
}  // namespace palpate::identify
