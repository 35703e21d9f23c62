// Rigid tools that touch, hold and move a body: what they weigh on it, and what it answers.

#include "fem/rig/tool_approach.h"
#include "mesh/errors.h"
#include "tests/fem/hollow.h"
#include "tests/fem/rig/rigged_bar.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(RigidShape, GapsAreDerivativesOfOneAnother) {
    const Vec3 centre(1, 2, 3);
    for (const auto& tool : {sphere_tool(centre, 2), flat_tool(centre, 2), box_tool(centre, Vec3(2, 1.5, 2))}) {
        const RigidShape& shape = *tool->shape;
        for (unsigned seed = 0; seed < 40; ++seed) {
            const Eigen::VectorXd y = centre + Vec3(scatter(3, 3.5, seed));
            const Gap gap = shape.gap(y);
            const auto value = [&](const Eigen::VectorXd& x) { return one(shape.gap(x).value); };
            const auto normal = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd(shape.gap(x).normal); };
            // Central differences of step 1e-5: their own error is 1e-10 over the least radius squared, rounding 1e-11
            // over it. The seeds keep away from where the nearest face, edge or corner changes.
            EXPECT_LT((differences(value, y, 1e-5).transpose() - gap.normal).norm(), 1e-8) << tool->tool.name << seed;
            EXPECT_LT((differences(normal, y, 1e-5) - gap.hessian).norm(), 1e-6) << tool->tool.name << seed;
            EXPECT_NEAR(gap.normal.norm(), 1, 1e-12);
        }
    }
}

TEST(RigidShape, GapsAreDistances) {
    const auto box = box_tool(Vec3::Zero(), Vec3(2, 1, 1))->shape, punch = flat_tool(Vec3::Zero(), 2)->shape;
    EXPECT_NEAR(box->gap(Vec3(3, 0.3, 0.1)).value, 1, 1e-14);
    EXPECT_NEAR(box->gap(Vec3(3, 2, 0)).value, std::sqrt(2), 1e-14);
    EXPECT_NEAR(box->gap(Vec3(3, 2, 2)).value, std::sqrt(3), 1e-14);
    EXPECT_NEAR(box->gap(Vec3(0.2, 0.9, 0.1)).value, -0.1, 1e-14);
    EXPECT_NEAR(punch->gap(Vec3(1, 0, -0.5)).value, 0.5, 1e-14);  // it presses downwards, and stands above z = 0
    EXPECT_NEAR(punch->gap(Vec3(1, 0, 0.5)).value, -0.5, 1e-14);
    EXPECT_NEAR(punch->gap(Vec3(1.9, 0, 0.5)).value, -0.1, 1e-14);
    EXPECT_NEAR(punch->gap(Vec3(2.3, 0, -0.4)).value, 0.5, 1e-14);
}

TEST(RigidShape, APointThatLeavesAPunchOverItsRimMeetsNoLeap) {
    const auto punch = flat_tool(Vec3::Zero(), 2)->shape;
    const Vec3 before(1.5, 0, 0);  // where the point would be: on the face
    EXPECT_EQ(punch->gap(Vec3(1.9, 0, 0.5), before).value, -0.5);
    for (const double beside : {-1e-12, 1e-12})
        EXPECT_NEAR(punch->gap(Vec3(2 + beside, 0, 0.5), before).value, -0.5, 1e-11);
    EXPECT_NEAR(punch->gap(Vec3(2.3, 0, 0.5), before).value, -0.2, 1e-14);
    EXPECT_NEAR(punch->gap(Vec3(2.6, 0, 0.5), before).value, 0.6, 1e-14);            // free of it
    EXPECT_NEAR(punch->gap(Vec3(1.9, 0, 0.5), Vec3(2.1, 0, 0)).value, -0.1, 1e-14);  // it came in through the side
    const Eigen::VectorXd y = Vec3(2.1, 0.3, 0.5);
    const Gap gap = punch->gap(y, before);
    const auto value = [&](const Eigen::VectorXd& x) { return one(punch->gap(x, before).value); };
    const auto normal = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd(punch->gap(x, before).normal); };
    EXPECT_LT((differences(value, y, 1e-5).transpose() - gap.normal).norm(), 1e-8);
    EXPECT_LT((differences(normal, y, 1e-5) - gap.hessian).norm(), 1e-6);
}

/// A bar with a tool of each kind at it.
struct Rigged {
    Beam beam{{6, 2, 2}, {4, 2, 2}};
    HyperelasticBody body = beam.body();
    double young = 0.3;
    Vec3 shift{-0.03, 0.02, -0.25}, turn{0.02, -0.1, 0.05};

    std::vector<std::shared_ptr<const ToolPotential>> tools() const {
        return {moved(sphere_tool(Vec3(3, 1, 4), 2), shift, turn, young),
                moved(flat_tool(Vec3(3, 1, 2), 0.8), shift, turn, young),
                moved(box_tool(Vec3(3, 1, 3), Vec3(0.9, 0.8, 1)), shift, turn, young),
                moved(grip_tool(5, Vec3(5.5, 1, 0)), shift, turn, young),
                moved(flat_tool(Vec3(3, 1, 2), 0.8, true), shift, turn, young)};
    }
    BodySetting setting(const std::shared_ptr<const ToolPotential>& tool, MaterialLaw law) const {
        return {law, {.young = young, .poisson = 0.4}, {.tools = {tool}}};
    }
    Eigen::VectorXd none() const { return Eigen::VectorXd::Zero(beam.mesh.nodes.size()); }
    /// Near where the body stands: within a shape by little, as the laws of derivatives ask for.
    Eigen::VectorXd near(const std::shared_ptr<const ToolPotential>& tool) const {
        const Eigen::VectorXd u = body.equilibrium(setting(tool, MaterialLaw::neo_hookean), none()).u;
        return u + scatter(u.size(), 1e-5);
    }
};

TEST(Tool, WrenchIsTheGradientOfTheEnergyByThePose) {
    const Rigged rig;
    const Eigen::VectorXd none = rig.none();
    for (const auto& tool : rig.tools()) {
        const Eigen::VectorXd u = rig.near(tool);
        const auto at = [&](const Eigen::VectorXd& step) {
            return std::make_shared<ToolPotential>(std::make_shared<RigidTool>(tool->tool()),
                                                   stepped(tool->motion(), step), rig.young);
        };
        const auto energy = [&](const Eigen::VectorXd& step) {
            return one(rig.body.potential(u, rig.setting(at(step), MaterialLaw::neo_hookean), none));
        };
        const auto wrench = [&](const Eigen::VectorXd& step) { return Eigen::VectorXd(rig.body.wrench(u, at(step))); };
        const auto force = [&](const Eigen::VectorXd& step) {
            return rig.body.residual(u, rig.setting(at(step), MaterialLaw::neo_hookean), none);
        };
        const Eigen::VectorXd nowhere = Eigen::VectorXd::Zero(6), own = rig.body.wrench(u, tool);
        EXPECT_GT(own.norm(), 0);
        // Differences of step 1e-7 carry six digits or so, of energies that are small parts of the body's four.
        EXPECT_LT((differences(energy, nowhere, 1e-7).transpose() - own).norm(), 1e-4 * own.norm())
            << tool->tool().name;
        const Eigen::MatrixXd slope = rig.body.wrench_by_pose(u, tool), M = rig.body.wrench_derivative(u, tool);
        EXPECT_LT((differences(wrench, nowhere, 1e-7) - slope).norm(), 1e-5 * slope.norm()) << tool->tool().name;
        EXPECT_LT((differences(force, nowhere, 1e-7) + M).norm(), 1e-5 * M.norm()) << tool->tool().name;
    }
}

TEST(Tool, WrenchAndTangentAreDerivativesByTheNodes) {
    const Rigged rig;
    const Eigen::VectorXd none = rig.none();
    for (const auto& tool : rig.tools()) {
        const Eigen::VectorXd u = rig.near(tool);
        for (const MaterialLaw law : laws) {
            const BodySetting setting = rig.setting(tool, law);
            const Eigen::VectorXd r = rig.body.residual(u, setting, none);
            const Eigen::SparseMatrix<double> J = rig.body.tangent(u, setting);
            const Eigen::MatrixXd M = rig.body.wrench_derivative(u, tool);
            for (unsigned seed = 1; seed < 4; ++seed) {
                const Eigen::VectorXd step = scatter(u.size(), 1, seed);
                const double h = 1e-7;
                const auto along = [&](const auto& value) {
                    return Eigen::VectorXd((value(u + h * step) - value(u - h * step)) / (2 * h));
                };
                // Differences carry six digits of the largest terms, as no point enters or leaves on the way.
                const auto energy = [&](const Eigen::VectorXd& at) {
                    return one(rig.body.potential(at, setting, none));
                };
                EXPECT_NEAR(along(energy)(0), -r.dot(step), 1e-5 * r.norm() * step.norm());
                const auto residual = [&](const Eigen::VectorXd& at) { return rig.body.residual(at, setting, none); };
                EXPECT_LT((along(residual) + J * step).norm(), 1e-5 * (J * step).norm()) << tool->tool().name;
                const auto wrench = [&](const Eigen::VectorXd& at) {
                    return Eigen::VectorXd(rig.body.wrench(at, tool));
                };
                EXPECT_LT((along(wrench) - M.transpose() * step).norm(), 1e-5 * (M.transpose() * step).norm());
            }
        }
    }
}

TEST(Tool, SupportsBearWhatToolsExert) {
    const Rigged rig;
    for (const auto& tool : rig.tools()) {
        for (const MaterialLaw law : laws) {
            const BodySetting setting = rig.setting(tool, law);
            const Eigen::VectorXd u = rig.body.equilibrium(setting, rig.none()).u;
            const Eigen::VectorXd r = rig.body.residual(u, setting, rig.none());
            Wrench support = Wrench::Zero();  // on the body, about the tool's origin
            for (Eigen::Index i = 0; i < rig.beam.mesh.nodes.rows(); ++i) {
                if (!rig.beam.held[i]) continue;
                const Vec3 force = -r.segment<3>(3 * i);
                const Vec3 x = rig.beam.mesh.nodes.row(i).transpose() + u.segment<3>(3 * i);
                support.head<3>() += force;
                support.tail<3>() += (x - tool->origin()).cross(force);
            }
            const Wrench own = rig.body.wrench(u, tool);
            // Newton's tolerance; in small strain moments are about where points rest, and off by as much as they move.
            EXPECT_LT((own + support).head<3>().norm(), 1e-5 * own.head<3>().norm()) << tool->tool().name;
            if (law != MaterialLaw::linear) {
                EXPECT_LT((own + support).norm(), 1e-5 * own.norm()) << tool->tool().name;
            }
        }
    }
}

TEST(Tool, ForcesOfToolsAloneLeaveTheShapeToTheirMotion) {
    // A body ten times as stiff answers with ten times the force, in the same shape.
    const Rigged rig;
    for (const auto& tool : rig.tools()) {
        const auto stiffer = moved(std::make_shared<RigidTool>(tool->tool()), rig.shift, rig.turn, 10 * rig.young);
        BodySetting soft = rig.setting(tool, MaterialLaw::neo_hookean), stiff = rig.setting(stiffer, soft.law);
        stiff.material.young *= 10;
        const Eigen::VectorXd u = rig.body.equilibrium(soft, rig.none()).u,
                              v = rig.body.equilibrium(stiff, rig.none()).u;
        EXPECT_LT(relative(v, u), 1e-6) << tool->tool().name;  // Newton's tolerance
        EXPECT_LT(relative(rig.body.wrench(v, stiffer), 10 * rig.body.wrench(u, tool)), 1e-5) << tool->tool().name;
        const Eigen::VectorXd grip = rig.body.grip_forces(u, soft);
        EXPECT_LT((grip.reshaped(3, grip.size() / 3).rowwise().sum() - rig.body.wrench(u, tool).head<3>()).norm(),
                  1e-9 * grip.norm());  // rounding
    }
}

TEST(Tool, WhatIsAwayDoesNothing) {
    const Rigged rig;
    const auto away = moved(sphere_tool(Vec3(3, 1, 4.1), 2), Vec3(5, 0, 0.1), Vec3::Zero(), rig.young);
    const BodySetting setting = rig.setting(away, MaterialLaw::neo_hookean);
    EXPECT_EQ(rig.body.equilibrium(setting, rig.none()).u, rig.none());
    EXPECT_EQ(rig.body.wrench(rig.none(), away), Wrench::Zero());
}

TEST(Tool, WhatItWillTouchIsFoundWithinAStep) {
    // Nothing but where a tilted face touches a linear body is nonlinear: one factor and the points that part, or come
    // in touch, are all that it takes.
    const Rigged rig;
    const auto tilted = moved(flat_tool(Vec3(3, 1, 2), 5), Vec3(0, 0, -0.3), Vec3(0.02, 0.1, 0), rig.young);
    const auto deeper = moved(flat_tool(Vec3(3, 1, 2), 5), Vec3(0, 0, -0.35), Vec3(0.02, 0.12, 0), rig.young);
    const BodyEquilibrium found = rig.body.equilibrium(rig.setting(tilted, MaterialLaw::linear), rig.none());
    EXPECT_EQ(found.iterations, 1);
    EXPECT_EQ(found.factorisations, 1);
    const BodyEquilibrium again =
        rig.body.equilibrium(rig.setting(deeper, MaterialLaw::linear), rig.none(), {}, &found.u);
    EXPECT_EQ(again.iterations, 1);
}

TEST(Tool, ThatRestsOnTheOtherSideComesFromOffTheBody) {
    const Rigged rig;
    const auto from_above = moved(sphere_tool(Vec3(3, 1, 4), 2), Vec3(0, 0, -0.25), Vec3::Zero(), rig.young);
    const auto from_below = moved(sphere_tool(Vec3(3, 1, -2), 2), Vec3(0, 0, 5.75), Vec3::Zero(), rig.young);
    const auto found = [&](const auto& tool) {
        return rig.body.equilibrium(rig.setting(tool, MaterialLaw::neo_hookean), rig.none());
    };
    const BodyEquilibrium near = found(from_above), far = found(from_below);
    EXPECT_LT((near.u - far.u).norm(), 1e-6 * near.u.norm());
    EXPECT_LT(far.factorisations, 2 * near.factorisations);
    // It is the tool in its pose, and off the body a little more than it is pressed in.
    const mesh::Surface skin = mesh::boundary_surface(rig.beam.mesh);
    const auto approach = from_off_the_body(*from_below, skin.vertices, mesh::vertex_normals(skin), Points::Zero(1, 3));
    ASSERT_TRUE(approach);
    EXPECT_TRUE(approach->likely);
    EXPECT_EQ(approach->tool->origin(), from_below->origin());
    EXPECT_NEAR(approach->tool->way(), 0.25, 0.1);
    const auto off = approach->tool->part_way(0);
    for (Eigen::Index node = 0; node < rig.beam.mesh.nodes.rows(); ++node)
        EXPECT_EQ(off->terms(rig.beam.mesh.nodes.row(node), rig.beam.mesh.nodes.row(node)).energy, 0);
}

TEST(Tool, PushesABeamByMoreThanItsThickness) {
    const Beam beam{{12, 1, 1}, {12, 2, 2}};
    const auto pushed = moved(sphere_tool(Vec3(9, 0.5, 3), 2), Vec3(0, 0, -3.5), Vec3::Zero(), 0.3);
    const BodySetting setting{MaterialLaw::neo_hookean, {.young = 0.3, .poisson = 0.4}, {.tools = {pushed}}};
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    const HyperelasticBody body = beam.body();
    const Eigen::VectorXd u = body.equilibrium(setting, none).u;
    EXPECT_LT(u.reshaped(3, u.size() / 3).row(2).minCoeff(), -3);
    EXPECT_LT(body.wrench(u, pushed).z(), 0);
    // On its far side the ball could stand as well.
    const mesh::Surface skin = mesh::boundary_surface(beam.mesh);
    const auto approach = from_off_the_body(*pushed, skin.vertices, mesh::vertex_normals(skin), Points::Zero(1, 3));
    ASSERT_TRUE(approach);
    EXPECT_FALSE(approach->likely);
}

TEST(Tool, PressedInByMoreThanItsRadiusComesFromOutside) {
    // Its centre is within the block: the surface that is nearest to it would leave it outwards.
    const Beam block{{10, 10, 8}, {6, 6, 5}};
    const auto at = [&](double depth) {
        return moved(sphere_tool(Vec3(6, 5, -20), 2), Vec3(0, 0, 30 - depth), Vec3::Zero(), 0.3);
    };
    const HyperelasticBody body = block.body();
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(block.mesh.nodes.size());
    const auto found = [&](double depth, const Eigen::VectorXd* start) {
        const BodySetting setting{MaterialLaw::neo_hookean, {.young = 0.3, .poisson = 0.4}, {.tools = {at(depth)}}};
        return body.equilibrium(setting, none, {}, start).u;
    };
    const Eigen::VectorXd u = found(2.6, nullptr);
    EXPECT_LT(body.wrench(u, at(2.6)).z(), 0);
    Eigen::VectorXd followed = Eigen::VectorXd::Zero(u.size());
    for (const double depth : {0.4, 0.8, 1.2, 1.6, 2.0, 2.3, 2.6}) followed = found(depth, &followed);
    EXPECT_LT((u - followed).norm(), 1e-4 * followed.norm());

    const mesh::Surface skin = mesh::boundary_surface(block.mesh);
    const auto approach = from_off_the_body(*at(2.6), skin.vertices, mesh::vertex_normals(skin), Points::Zero(1, 3));
    ASSERT_TRUE(approach);
    EXPECT_TRUE(approach->likely);
    EXPECT_NEAR(approach->tool->way(), 2.6, 0.2);
    EXPECT_GT(approach->tool->part_way(0)->origin().z(), 9.9);
}

TEST(Tool, MessagesSayWhatToDo) {
    const Rigged rig;
    const auto equilibrium = [&](const std::shared_ptr<const RigidTool>& tool) {
        return [&, tool] {
            rig.body.equilibrium(rig.setting(moved(tool, rig.shift, rig.turn, 1), MaterialLaw::linear), rig.none());
        };
    };
    EXPECT_THAT(
        equilibrium(grip_tool(100, Vec3::Zero())),
        testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("\"grip\" hold no material"), HasSubstr("widen"))));
    EXPECT_THAT(
        equilibrium(sphere_tool(Vec3(3, 1, 9), 2, true)),
        testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("\"ball\" touches no surface"), HasSubstr("Move it"))));
    EXPECT_THAT(
        [] { sphere_tool(Vec3::Zero(), 0); },
        testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("\"ball\""), HasSubstr("0 mm"), HasSubstr("more than"))));
    mesh::Tool flat{.name = "punch", .shape = mesh::FlatShape{1, Vec3::Zero()}};
    EXPECT_THAT([&] { RigidTool{flat}; }, testing::ThrowsMessage<InvalidInput>(HasSubstr("direction that it presses")));
    mesh::Surface box = mesh::make_box(Vec3::Zero(), Vec3::Ones(), Eigen::Vector3i::Ones());
    mesh::Tool open{.name = "cup", .shape = mesh::SurfaceShape{box}};
    std::get<mesh::SurfaceShape>(open.shape).surface.triangles.conservativeResize(11, 3);
    EXPECT_THAT([&] { RigidTool{open}; },
                testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("\"cup\" is open"), HasSubstr("Close"))));
    box.triangles.col(0).swap(box.triangles.col(1));
    open.shape = mesh::SurfaceShape{box};
    EXPECT_THAT([&] { RigidTool{open}; }, testing::ThrowsMessage<InvalidInput>(HasSubstr("Turn them round")));
    EXPECT_THAT(equilibrium(grip_tool(5, Vec3(0, 0, 0))), testing::Not(testing::Throws<InvalidInput>()));
    const auto crushed = moved(grip_tool(5, Vec3::Zero()), Vec3(-20, 0, 0), Vec3::Zero(), 1);
    EXPECT_THAT([&] { rig.body.equilibrium(rig.setting(crushed, MaterialLaw::neo_hookean), rig.none()); },
                testing::ThrowsMessage<SolverFailure>(AllOf(HasSubstr("\"grip\" moved by 20 mm"), HasSubstr("unit"))));
}

}  // namespace
}  // namespace palpate::fem
