// The runtime's equilibria are those of the model in skeleton/.

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "skeleton/model/attachment/carried_point.h"
#include "skeleton/model/growth.h"
#include "skeleton/runtime/body.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/skeleton/runtime/live_models.h"

namespace palpate::runtime {
namespace {

using skeleton::testing::make_chain;
using skeleton::testing::make_full_lattice;
using skeleton::testing::make_lattice;

// Pushes on a vertex in both; how far the spheres are apart then [mm], and the largest displacement [mm].
struct Apart {
    double most = 0, moved = 0;
    EquilibriumReport report;
};

Apart apart_under_push(const skeleton::Model& model, int vertex, const Vec3& force) {
    skeleton::Load load;
    load.forces.push_back({model.skin[vertex], force});
    const skeleton::Equilibrium expected = skeleton::equilibrium(model, load);

    Body body(model);
    // where the vertex stands at the beginning: its spheres have parted where the material has grown
    const fem::Growth growth = skeleton::physics_of(model.effects).growth;
    const int contact = body.touch(
        skeleton::carried_place(model.skin[vertex], skeleton::rest_state(model), skeleton::grown_start(model, growth)));
    body.push(contact, force);
    Apart apart;
    apart.report = body.equilibrium();
    for (int i = 0; i < body.sphere_count(); ++i) {
        const Vec3 x = expected.state.x.row(i).transpose();
        apart.most = std::max(apart.most, (body.position(i) - x).norm());
        apart.moved = std::max(apart.moved, (x - model.spheres[i].center).norm());
    }
    return apart;
}

// skeleton::equilibrium stops at 1e-9 of the force, so about 1e-9 of the displacement.
constexpr double as_good = 1e-8;
// The runtime stops at 1e-9 of a link of 10 mm.
constexpr double settled = 1e-8;  // [mm]

TEST(LiveEquilibrium, IsThatOfTheModel) {
    for (skeleton::Model model : {make_lattice({4, 3, 2}), make_full_lattice({4, 3, 2})}) {
        give_skin(model);
        const Apart apart = apart_under_push(model, 100, {0.5, 2, -3});
        EXPECT_GT(apart.moved, 1);  // [mm], a tenth of a link
        EXPECT_LT(apart.most, as_good * apart.moved);
        EXPECT_LE(apart.report.iterations, 9);  // by Newton's method: 7
    }
}

TEST(LiveEquilibrium, HoldsWithEffectsInForce) {
    for (const skeleton::EffectRecord& effect : playable_effects()) {
        skeleton::Model model = make_full_lattice({4, 3, 2});
        give_skin(model);
        model.effects = {effect};
        const Apart apart = apart_under_push(model, 100, {0.2, 0.5, -1});
        EXPECT_LT(apart.most, as_good * apart.moved) << effect.name;
    }
}

TEST(LiveEquilibrium, ShowsTheSkinAsFarOutAsItHasGrown) {
    skeleton::Model model = make_full_lattice({4, 3, 2});
    give_skin(model);
    const Points before = model.surface.vertices;
    model.effects = {{"swelling", {{"growth", 0.05, ""}}}};
    Body body(model);
    body.equilibrium();
    const Points expected = skeleton::observe(model, skeleton::equilibrium(model, {}), model.skin);
    using Shown = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Eigen::Map<const Shown> shown(body.skin().data(), expected.rows(), 3);
    EXPECT_LT((shown.cast<double>() - expected).rowwise().norm().maxCoeff(),
              1e-5);  // single precision (2^-24) of 30 mm, and of what makes it up
    EXPECT_GT((expected - before).rowwise().norm().maxCoeff(), 1.5);  // 5 % of 40 mm
}

TEST(LiveEquilibrium, HoldsUnderPressure) {
    skeleton::Model model = make_full_lattice({4, 3, 3});
    give_skin(model);
    add_cavity(model);
    model.effects = {{"pressure", {{"pressure", 0.01, "MPa"}}}};
    const Apart apart = apart_under_push(model, 100, {0.2, 0.5, -1});
    EXPECT_LT(apart.most, as_good * apart.moved);
}

TEST(LiveEquilibrium, IsFoundAgainAndAgain) {
    skeleton::Model chain = make_chain(200), lattice = make_full_lattice({9, 4, 3});
    for (skeleton::Model* model : {&chain, &lattice}) {
        give_skin(*model);
        Body body(*model);
        const auto last = static_cast<int>(model->spheres.size()) - 1;
        const Vec3 tip = model->spheres[last].center;
        const int contact = body.touch(tip);
        body.push(contact, model == &chain ? Vec3(0, 1e-3, 0) : Vec3(0, 0, -1));
        body.equilibrium();
        const Vec3 force = body.force(contact), bent = body.position(last);
        EXPECT_GT((bent - tip).norm(), 4);  // [mm], half a link
        for (int i = 0; i < 8; ++i) {
            body.push(contact, Vec3::Zero());
            body.equilibrium();
            EXPECT_LT((body.position(last) - tip).norm(), settled);
            body.push(contact, force);
            body.equilibrium();
            EXPECT_LT((body.position(last) - bent).norm(), settled);
        }
    }
}

TEST(LiveEquilibrium, ADragPullsAsItsSpringIsLong) {
    skeleton::Model model = make_full_lattice({4, 3, 2});
    give_skin(model);
    Body body(model);
    const Vec3 start = model.surface.vertices.row(100);
    const int dragged = body.touch(start);
    const Vec3 to = start + Vec3(0, 3, -4);
    body.drag(dragged, to, 0.7);
    body.equilibrium();
    const Vec3 force = body.force(dragged);
    EXPECT_LT((force - 0.7 * (to - body.place(dragged))).norm(), 1e-14 * force.norm());  // rounding
    EXPECT_GT(force.norm(), 2);  // [N] of 5 mm at 0.7 N/mm, of which the body gives a part

    // The same force, told, leads to the same place.
    Body pushed(model);
    pushed.push(pushed.touch(start), force);
    pushed.equilibrium();
    for (int i = 0; i < body.sphere_count(); ++i) {
        EXPECT_LT((body.position(i) - pushed.position(i)).norm(), settled);
    }
}

TEST(LiveEquilibrium, YieldsAndRemembersAsTheModelDoes) {
    skeleton::Model model = make_chain(6);
    give_skin(model);
    model.effects = {{"plasticity", {{"yield", 0.01, ""}, {"hardening", 0.2, ""}}}};
    skeleton::Load load;
    load.forces.push_back({model.skin[100], Vec3(0.3, 0, 0)});
    const skeleton::Equilibrium loaded = skeleton::equilibrium(model, load);
    const skeleton::FibreStates flowed = skeleton::flowed(model, loaded);
    const skeleton::Equilibrium after = skeleton::equilibrium(model, {}, {}, &loaded.state, flowed);
    ASSERT_GT((after.state.x - skeleton::rest_state(model).x).norm(), 0.1);  // [mm], 1e7 times what is compared

    Body body(model);
    body.push(body.touch(model.surface.vertices.row(100).transpose()), {0.3, 0, 0});
    body.equilibrium();
    body.push(0, Vec3::Zero());
    body.equilibrium();
    for (int i = 0; i < body.sphere_count(); ++i) {
        EXPECT_LT((body.position(i) - after.state.x.row(i).transpose()).norm(), settled) << i;
    }
    body.reset();
    body.equilibrium();
    EXPECT_LT((body.position(6) - model.spheres[6].center).norm(), 3e-14);  // rounding of 60 mm
}

TEST(LiveEquilibrium, IsSofterAfterMoreAsTheModelIs) {
    skeleton::Model model = make_chain(6);
    give_skin(model);
    model.effects = {{"damage", {{"share", 0.6, ""}, {"strain", 0.03, ""}}}};
    const auto pulled = [&](double force) {
        skeleton::Load load;
        load.forces.push_back({model.skin[100], Vec3(force, 0, 0)});
        return load;
    };
    const skeleton::Equilibrium most = skeleton::equilibrium(model, pulled(0.3));
    const skeleton::Equilibrium less =
        skeleton::equilibrium(model, pulled(0.1), {}, &most.state, skeleton::flowed(model, most));
    ASSERT_GT((less.state.x - skeleton::equilibrium(model, pulled(0.1)).state.x).norm(), 0.1);  // as above

    Body body(model);
    body.push(body.touch(model.surface.vertices.row(100).transpose()), {0.3, 0, 0});
    body.equilibrium();
    body.push(0, {0.1, 0, 0});
    body.equilibrium();
    for (int i = 0; i < body.sphere_count(); ++i) {
        EXPECT_LT((body.position(i) - less.state.x.row(i).transpose()).norm(), settled) << i;
    }
}

TEST(LiveEquilibriumMessages, ABodyThatNothingHoldsHasNone) {
    skeleton::Model model = make_chain(3);
    model.spheres[0].held = false;
    Body body(model);
    EXPECT_EQ(message_of<SolverFailure>([&] { body.equilibrium(); }),
              "the body is unconstrained and has no equilibrium: let a support hold a sphere");
}

}  // namespace
}  // namespace palpate::runtime
