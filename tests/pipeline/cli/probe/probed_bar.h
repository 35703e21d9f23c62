#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {

/// A bar of 60 x 20 x 20 mm, held at x = 0, E = 0.1 MPa, and sets that are made of it.
class Probe : public ::testing::Test {
protected:
    void SetUp() override {
        mesh::write_surface(scratch_ / "bar.stl", mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2}));
    }

    commands::ProbeCommandOptions options(const BlindSetOptions& synthesis, const std::string& name) const {
        commands::ProbeCommandOptions result{
            .input = scratch_ / "bar.stl", .output = scratch_ / name, .overrides = {}, .synthesis = synthesis};
        result.overrides.set("volume.edge_length", 12);
        result.overrides.set("probing.probes", 8);
        result.overrides.set("probing.markers", 40);
        return result;
    }
    identify::MeasurementSet probe(const BlindSetOptions& synthesis, const std::string& name = "set",
                                   int threads = 1) const {
        commands::probe(options(synthesis, name), {.json = false, .force = false, .threads = threads, .seed = {}});
        return identify::read_measurement_set(scratch_ / name);
    }
    identify::MeasurementSet hide(const std::vector<std::string>& effects, const std::string& name = "set") const {
        return probe({.hide = effects}, name);
    }
    std::string text(const std::string& file) const { return mesh::read_text(scratch_ / file); }
    nlohmann::json truth(const std::string& name = "set") const {
        return nlohmann::json::parse(text(name + "/truth.json"));
    }
    std::string message(const BlindSetOptions& synthesis) const {
        return message_of<InvalidInput>([&] { commands::probe(options(synthesis, "refused"), {}); });
    }

    const TemporaryFolder scratch_;
};

inline const identify::LoadState& state_of(const identify::MeasurementSet& set, const identify::LoadState& like) {
    for (const identify::LoadState& state : set.states) {
        if (state.probe == like.probe && state.time == like.time) return state;
    }
    throw std::runtime_error("no such state");
}

/// rms over coordinates of what the readings of two sets differ by [mm].
inline double rms_difference(const identify::MeasurementSet& a, const identify::MeasurementSet& b) {
    double squares = 0;
    int count = 0;
    for (const identify::LoadState& state : a.states) {
        const identify::LoadState& other = state_of(b, state);
        for (std::size_t r = 0; r < state.readings.size(); ++r) {
            squares += (state.readings[r].position - other.readings[r].position).squaredNorm();
            count += 3;
        }
    }
    return std::sqrt(squares / count);
}

}  // namespace palpate::pipeline
