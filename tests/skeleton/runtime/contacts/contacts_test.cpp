// Contacts and the skin.

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "skeleton/loads/dent.h"
#include "skeleton/model/observation.h"
#include "skeleton/runtime/body.h"
#include "tests/messages.h"
#include "tests/skeleton/runtime/live_models.h"

namespace palpate::runtime {
namespace {

using skeleton::testing::make_full_lattice;

skeleton::Model skinned() {
    skeleton::Model model = make_full_lattice({4, 3, 2});
    give_skin(model);
    return model;
}

Points positions(Body& body) {
    const std::vector<float>& skin = body.skin();
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(skin.data(), body.vertex_count(),
                                                                                      3)
        .cast<double>();
}

TEST(LiveSkin, FollowsAsTheModelSays) {
    const skeleton::Model model = skinned();
    std::mt19937_64 engine(9);
    for (const double turn : {0.1, 1.0}) {
        const skeleton::State state = skeleton::testing::random_state(model, engine, 3, turn);
        Body body(model);
        for (int i = 0; i < body.sphere_count(); ++i) {
            body.set_pose(i, state.x.row(i).transpose(), Eigen::Quaterniond(state.R[i]));
        }
        const Points expected = skeleton::observe(model, state, model.skin);
        // single precision (2^-24) on positions of some 50 mm, and on the products that they are the sum of
        EXPECT_LT((positions(body) - expected).cwiseAbs().maxCoeff(), 8e-6);
    }
}

TEST(LiveSkin, RigidMotionsAreFollowedExactly) {
    const skeleton::Model model = skinned();
    const Mat3 R = skeleton::rotation({1, 2, -1.5});
    const Vec3 shift(5, -7, 11);
    Body body(model);
    for (int i = 0; i < body.sphere_count(); ++i) {
        body.set_pose(i, R * model.spheres[i].center + shift, Eigen::Quaterniond(R));
    }
    const Points moved = (model.surface.vertices * R.transpose()).rowwise() + shift.transpose();
    EXPECT_LT((positions(body) - moved).cwiseAbs().maxCoeff(), 6e-6);  // as above
}

TEST(LiveSkin, IsDentedAsTheModelSays) {
    skeleton::Model model = skinned();
    model.dent << 0.5, 0.2, 0.3, 0.1, 0.2, 0.05;
    const Vec3 at(20, 10, 14), force(0.1, 0.2, -1);
    Body body(model);
    const int contact = body.touch(at, 3);
    body.push(contact, force);
    body.equilibrium();
    Body bare(skinned());
    bare.push(bare.touch(at, 3), force);
    bare.equilibrium();
    const Points dented = positions(body) - positions(bare);
    EXPECT_GT(dented.rowwise().norm().maxCoeff(), 0.2);  // [mm]: a dent is seen

    // Points of a fine grid on the disc stand for the patch; the skin is flat there.
    const double height = model.surface.vertices.col(2).maxCoeff();
    skeleton::Load load;
    load.patch_forces.push_back({force, Vec3::UnitZ(), 3, {}});
    for (int i = -40; i <= 40; ++i) {
        for (int j = -40; j <= 40; ++j) {
            const Vec3 p(at.x() + 0.075 * i, at.y() + 0.075 * j, height);
            if (std::hypot(0.075 * i, 0.075 * j) <= 3) load.patch_forces[0].patch.emplace_back(p, 1);
        }
    }
    for (auto& [p, share] : load.patch_forces[0].patch) share /= static_cast<double>(load.patch_forces[0].patch.size());
    const Points expected = skeleton::dents(model, load, model.surface.vertices);
    // both are sampled, the body's at a third of the radius: 0.9 %
    EXPECT_LT((dented - expected).rowwise().norm().maxCoeff(), 0.012 * expected.rowwise().norm().maxCoeff());
}

TEST(LiveContact, TakesTheNearestPointOfTheSkinAsItStands) {
    const skeleton::Model model = skinned();
    Body body(model);
    const double top = model.surface.vertices.col(2).maxCoeff();
    const int contact = body.touch({20, 10, top + 5});
    EXPECT_LT((body.place(contact) - Vec3(20, 10, top)).norm(), 5e-6);  // the skin is in single precision
    EXPECT_EQ(body.force(contact), Vec3::Zero());

    // Lifted by 30 mm, what was the bottom is nearest to where the top was.
    for (int i = 0; i < body.sphere_count(); ++i) {
        body.set_pose(i, model.spheres[i].center + Vec3(0, 0, 30), Eigen::Quaterniond::Identity());
    }
    const int other = body.touch({20, 10, top + 5});
    EXPECT_LT(std::abs(body.place(other).z() - (model.surface.vertices.col(2).minCoeff() + 30)), 5e-6);  // as above
}

TEST(LiveContact, ARadiusSpreadsTheForce) {
    const skeleton::Model model = skinned();
    Body body(model);
    const Vec3 at(20, 10, model.surface.vertices.col(2).maxCoeff());
    const int spread = body.touch(at, 4);
    EXPECT_LT((body.place(spread) - at).norm(), 0.06);  // of a patch sampled at a third of its radius: 0.04 mm
}

TEST(LiveContactMessages, SayWhatIsAllowed) {
    const skeleton::Model model = skinned();
    Body body(model, {.contacts = 1});
    EXPECT_EQ(message_of<InvalidInput>([&] { body.force(0); }),
              "contact 0 is not in use; touch() gives contacts their numbers");
    const int contact = body.touch({0, 0, 0});
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  body.touch({0, 0, 0});
              }),
              "all 1 contacts are in use; release one, or make the body with more");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  body.drag(contact, {0, 0, 0}, 0);
              }),
              "the stiffness of a drag is 0; it must be above 0");
    body.release(contact);
    EXPECT_EQ(body.touch({0, 0, 0}), 0);
    EXPECT_EQ(message_of<InvalidInput>([&] { body.position(24); }),
              "sphere 24 does not exist; spheres are numbered from 0 to 23");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  Body(make_full_lattice({2, 2, 2})).touch({0, 0, 0});
              }),
              "the model has no skin that could be touched: give it one");
}

TEST(LiveNotices, TellWhatIsNotPlayed) {
    skeleton::Model model = skinned();
    EXPECT_TRUE(Body(model).notices().empty());
    model.law = skeleton::EquilibriumLaw::linear;
    model.effects = {
        {"viscosity", {{"creep", 0.5, ""}, {"tau", 2, ""}}}, {"volume", {{"poisson", 0.3, ""}}}, {"outliers", {}}};
    EXPECT_EQ(Body(model).notices(),
              (std::vector<std::string>{
                  "the model follows the linear law; it is played in large rotation",
                  "effect 'volume' acts on solids alone: a skeleton's volumes have stiffnesses of their own",
                  "effect 'outliers' is about the measurement, not the body"}));
}

}  // namespace
}  // namespace palpate::runtime
