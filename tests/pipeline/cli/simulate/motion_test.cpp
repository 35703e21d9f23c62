#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "skeleton/model/io/model_io.h"
#include "tests/pipeline/exports/exported_model.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

TEST(SimulateMotion, RingsAndComesToRestInTheEquilibrium) {
    const TemporaryFolder scratch;
    skeleton::write_model(scratch / "model.json", exported_model());
    mesh::write_text(scratch / "probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n1,0,80,80,40,0,0,-2,0\n");
    const commands::SimulateOptions still{scratch / "model.json", scratch / "probes.csv", scratch / "still"};
    const double end = commands::simulate(still, {}).json["states"][0]["max_displacement_mm"];
    for (const bool implicit : {false, true}) {
        commands::SimulateOptions moving{scratch / "model.json", scratch / "probes.csv", scratch / "moving", 0.001,
                                         0.3};
        moving.implicit = implicit;
        moving.damping = 0.2;
        const commands::Outcome outcome = commands::simulate(moving, {});
        const auto& probe = outcome.json["probes"][0];
        EXPECT_EQ(probe["frames"], 301);
        // A weight let go swings beyond where it comes to rest, by exp(-pi zeta / sqrt(1 - zeta^2)) = 0.53 at most.
        EXPECT_GT(probe["max_displacement_mm"], 1.2 * end);
        EXPECT_LT(probe["max_displacement_mm"], 1.6 * end);
        const auto frame = [&](int i) {
            return mesh::read_text(scratch / "moving" / fmt::format("simulation_{:05}.vtp", i));
        };
        EXPECT_NE(frame(10), frame(40));
    }
}

TEST(SimulateMotion, BeginsInTheEquilibriumOfARowOfTimeZero) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.damping = {.alpha = 0, .beta = 0.01};
    skeleton::write_model(scratch / "model.json", model);
    const std::string pressed = "probe,time,x,y,z,fx,fy,fz,radius\n1,0,80,80,40,0,0,-2,0\n";
    mesh::write_text(scratch / "pressed.csv", pressed);
    mesh::write_text(scratch / "released.csv", pressed + "1,1,0,0,0,0,0,0,0\n");
    const double start = commands::simulate({scratch / "model.json", scratch / "pressed.csv", scratch / "still"}, {})
                             .json["states"][0]["max_displacement_mm"];
    commands::SimulateOptions moving{scratch / "model.json", scratch / "released.csv", scratch / "moved", 0.001, 0.3};
    moving.implicit = true;
    const nlohmann::json told = commands::simulate(moving, {}).json;
    EXPECT_NEAR(told["probes"][0]["max_displacement_mm"].get<double>(), start, 0.01 * start);  // where it was let go
    EXPECT_EQ(told["damping"]["stiffness"], 0.01);
}

TEST(SimulateMotion, CreepsFromLoadToLoadAsStatesDo) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.damping = {.alpha = 0, .beta = 0.01};
    model.effects.push_back({"viscosity", {{"creep", 0.8, "1"}, {"tau", 0.4, "s"}}});
    skeleton::write_model(scratch / "model.json", model);
    mesh::write_text(scratch / "probes.csv",
                     "probe,time,x,y,z,fx,fy,fz,radius\n1,0.5,80,80,40,0,0,-1,0\n1,1.5,80,80,40,0,0,-2,0\n");
    const commands::SimulateOptions still{scratch / "model.json", scratch / "probes.csv", scratch / "still"};
    const double end = commands::simulate(still, {}).json["states"][1]["max_displacement_mm"];
    commands::SimulateOptions moving{scratch / "model.json", scratch / "probes.csv", scratch / "moved", 0.01, 1.5};
    moving.implicit = true;
    const double reached = commands::simulate(moving, {}).json["probes"][0]["max_displacement_mm"];
    EXPECT_NEAR(reached, end,
                0.01 * end);  // steps are a fortieth of the time of the creep
}

}  // namespace
}  // namespace palpate::pipeline
