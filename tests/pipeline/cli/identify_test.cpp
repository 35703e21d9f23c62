// The skeleton's fit to measurements, as a user asks for it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

/// A stout block held by its end face, of which a coarse skeleton is off by an eighth of the displacement as long as
/// its readings weigh as little as that error has them.
TEST(IdentifyCommand, ALargeModelErrorDoesNotHoldItself) {
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "block.stl", mesh::make_box({0, 0, 0}, {84, 40, 30}, {1, 1, 1}));
    scratch.write("case.yaml",
                  "format: palpate-case/1\nname: block\nmesh: block.stl\n"
                  "supports:\n  - box: {min: [-1, -1, -1], max: [3, 41, 31]}\n"
                  "volume: {edge_length: 9}\nmaterial: {young: 0.05, poisson: 0.45}\n");
    commands::ProbeCommandOptions probe{
        .input = scratch / "case.yaml", .output = scratch / "set", .overrides = {}, .synthesis = {.hide = {"none"}}};
    probe.overrides.set("probing.probes", 12);
    commands::probe(probe, {.json = false, .force = false, .threads = 1, .seed = 2});
    commands::SkeletonOptions skeleton{.input = scratch / "set", .output = scratch / "model.json", .overrides = {}};
    skeleton.overrides.set("skeleton.spheres", 20);
    commands::skeleton(skeleton, {});
    commands::identify(
        {.model = scratch / "model.json", .set = scratch / "set", .output = scratch / "fit", .overrides = {}}, {});
    const auto identified = nlohmann::json::parse(mesh::read_text(scratch / "fit/identify.json"));
    // 11.4 % where the fit stays under the error that it began with.
    EXPECT_LT(identified["model_error"].get<double>(), 0.1);
}

}  // namespace
}  // namespace palpate::pipeline
