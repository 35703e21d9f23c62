#include <gtest/gtest.h>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "skeleton/model/io/model_io.h"
#include "tests/messages.h"
#include "tests/pipeline/exports/exported_model.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

TEST(ExportCommand, WritesTheStateThatIsAskedFor) {
    const TemporaryFolder scratch;
    const skeleton::Model model = exported_model();
    skeleton::write_model(scratch / "model.json", model);
    mesh::write_text(scratch / "probes.csv",
                     "probe,time,x,y,z,fx,fy,fz,radius\n1,0,80,80,40,0,0,-2,0\n1,1,80,80,40,0,0,-4,0\n");
    commands::ExportOptions options{scratch / "model.json", scratch / "pressed.stl", "stl", scratch / "probes.csv", {}};
    commands::Common replacing;
    replacing.force = true;
    const auto lowest = [&] {
        commands::export_model(options, replacing);
        return mesh::read_surface(options.output).vertices.col(2).minCoeff();
    };
    const double last = lowest();
    options.state = 0;
    const double first = lowest();
    EXPECT_LT(last, first);
    options.state = 2;
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { lowest(); }), {"--state is 2", "has states 0 to 1"}));
    options = {scratch / "model.json", scratch / "body.vtp", "vtp", {}, {}};
    commands::export_model(options, {});
    EXPECT_EQ(mesh::read_surface(options.output).vertices.rows(), model.surface.vertices.rows());
}

TEST(ExportMessages, AModelWithoutASkinHasNothingToShow) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.skin.clear();
    model.surface = {};
    skeleton::write_model(scratch / "model.json", model);
    for (const char* to : {"gltf", "stl", "vtp"}) {
        const commands::ExportOptions options{scratch / "model.json", scratch / "body", to, {}, {}};
        EXPECT_TRUE(says(message_of<InvalidInput>([&] { commands::export_model(options, {}); }), {"no skin"})) << to;
    }
    const commands::SimulateOptions moving{scratch / "model.json", scratch / "p.csv", scratch / "out", 0.01, 0.1};
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { commands::simulate(moving, {}); }), {"has no skin"}));
}

}  // namespace
}  // namespace palpate::pipeline
