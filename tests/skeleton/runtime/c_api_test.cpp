// The C interface gives what the C++ one does, and says what went wrong.

#include <gtest/gtest.h>

#include "skeleton/model/io/model_io.h"
#include "skeleton/runtime/body.h"
#include "skeleton/runtime/palpate_runtime.h"
#include "tests/skeleton/runtime/live_models.h"
#include "tests/temporary_folder.h"

namespace palpate::runtime {
namespace {

TEST(CInterface, PlaysAModelFromItsFile) {
    const TemporaryFolder scratch;
    skeleton::Model model = skeleton::testing::make_full_lattice({4, 3, 2});
    give_skin(model);
    skeleton::write_model(scratch / "model.json", model);
    Body expected(scratch / "model.json");
    const Vec3 at = model.surface.vertices.row(100), to = at + Vec3(0, 3, -4);

    palpate_body* body = nullptr;
    ASSERT_EQ(palpate_open((scratch / "model.json").c_str(), 4, &body), PALPATE_OK) << palpate_message();
    EXPECT_EQ(palpate_sphere_count(body), 24);
    EXPECT_EQ(palpate_link_count(body), expected.link_count());
    EXPECT_EQ(palpate_vertex_count(body), model.surface.vertices.rows());
    EXPECT_EQ(palpate_triangle_count(body), model.surface.triangles.rows());
    EXPECT_EQ(palpate_notice(body, 0), nullptr);
    int contact = -1;
    ASSERT_EQ(palpate_touch(body, at.data(), 0, &contact), PALPATE_OK);
    const int same = expected.touch(at);
    for (int i = 0; i < 50; ++i) {
        ASSERT_EQ(palpate_drag(body, contact, to.data(), 0.5), PALPATE_OK);
        ASSERT_EQ(palpate_step_implicit(body, 1e-3), PALPATE_OK);
        expected.drag(same, to, 0.5);
        expected.step_implicit(1e-3);
    }
    double h = 0;
    ASSERT_EQ(palpate_stable_step(body, &h), PALPATE_OK);
    EXPECT_EQ(h, expected.stable_step());
    ASSERT_EQ(palpate_step_explicit(body, h / 4, 3), PALPATE_OK);
    expected.step_explicit(h / 4, 3);
    Vec3 force, place, x;
    Eigen::Vector4d q;
    ASSERT_EQ(palpate_contact(body, contact, force.data(), place.data()), PALPATE_OK);
    EXPECT_EQ(force, expected.force(same));
    EXPECT_EQ(place, expected.place(same));
    ASSERT_EQ(palpate_sphere(body, 5, x.data(), q.data()), PALPATE_OK);
    EXPECT_EQ(x, expected.position(5));
    const float* skin = nullptr;
    ASSERT_EQ(palpate_skin(body, &skin), PALPATE_OK);
    EXPECT_EQ(skin[7], expected.skin()[7]);
    double kinetic = 0, potential = 0;
    ASSERT_EQ(palpate_energy(body, &kinetic, &potential), PALPATE_OK);
    EXPECT_EQ(kinetic, expected.energy().kinetic);
    palpate_close(body);
}

TEST(CInterface, SetsThePressureInACavity) {
    const TemporaryFolder scratch;
    skeleton::Model model = skeleton::testing::make_full_lattice({4, 3, 2});
    give_skin(model);
    add_cavity(model);
    skeleton::write_model(scratch / "model.json", model);
    palpate_body* body = nullptr;
    ASSERT_EQ(palpate_open((scratch / "model.json").c_str(), 4, &body), PALPATE_OK) << palpate_message();
    int cavity = -1;
    ASSERT_EQ(palpate_find_cavity(body, Vec3(10, 10, 5).data(), &cavity), PALPATE_OK);
    EXPECT_EQ(cavity, 0);
    ASSERT_EQ(palpate_set_cavity_pressure(body, cavity, 0.02), PALPATE_OK);
    ASSERT_EQ(palpate_equilibrium(body), PALPATE_OK);
    Vec3 x;
    ASSERT_EQ(palpate_sphere(body, 23, x.data(), nullptr), PALPATE_OK);
    Body expected(scratch / "model.json");
    expected.set_cavity_pressure(0, 0.02);
    expected.equilibrium();
    EXPECT_EQ(x, expected.position(23));
    EXPECT_EQ(palpate_set_cavity_pressure(body, 1, 0.02), PALPATE_BAD_INPUT);
    palpate_close(body);
}

TEST(CInterface, SaysWhatWentWrong) {
    const TemporaryFolder scratch;
    palpate_body* body = nullptr;
    EXPECT_EQ(palpate_open((scratch / "none.json").c_str(), 4, &body), PALPATE_BAD_INPUT);
    EXPECT_EQ(body, nullptr);
    EXPECT_NE(std::string(palpate_message()).find("none.json"), std::string::npos);

    skeleton::Model model = skeleton::testing::make_chain(3);
    model.spheres[0].held = false;
    skeleton::write_model(scratch / "free.json", model);
    ASSERT_EQ(palpate_open((scratch / "free.json").c_str(), 4, &body), PALPATE_OK);
    EXPECT_EQ(palpate_equilibrium(body), PALPATE_NO_SOLUTION);
    EXPECT_STREQ(palpate_message(), "the body is unconstrained and has no equilibrium: let a support hold a sphere");
    EXPECT_EQ(palpate_release(body, 0), PALPATE_BAD_INPUT);
    palpate_close(body);
    palpate_close(nullptr);
}

}  // namespace
}  // namespace palpate::runtime
