#pragma once

#include <filesystem>

#include "mesh/formats/surface/read_surface.h"
#include "pipeline/command_line/commands.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {

/// A small beam, written to a folder and probed six times.
inline commands::RunOptions beam_options(const std::filesystem::path& from, const std::filesystem::path& to) {
    mesh::write_surface(from / "beam.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2}));
    commands::RunOptions options{.input = from / "beam.stl", .output = to, .overrides = {}};
    options.overrides.set("volume.edge_length", 14);
    options.overrides.set("skeleton.spheres", 6);
    options.overrides.set("probing.probes", 6);
    options.overrides.set("identify.particles", 40);
    options.overrides.set("identify.parameters", "uniform");
    return options;
}

/// A run on a small beam, made once for all tests.
inline const std::filesystem::path& beam_run() {
    static const TemporaryFolder scratch;
    static const std::filesystem::path run = [] {
        commands::run(beam_options(scratch.path(), scratch / "run"), {});
        return scratch / "run";
    }();
    return run;
}

}  // namespace palpate::pipeline
