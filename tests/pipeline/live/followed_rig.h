#pragma once

#include <filesystem>
#include <fstream>
#include <stop_token>

#include "identify/numerics/random.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/live/follow.h"
#include "skeleton/model/io/model_io.h"
#include "tests/identify/lattice.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

namespace palpate::pipeline {

/// A small lattice in a box, its set on disk, and rows that are still to come.
struct FollowedRig {
    TemporaryFolder folder;
    skeleton::Model model = identify::make_lattice({3, 2, 1});
    identify::MeasurementSet set;

    FollowedRig() {
        model.surface = mesh::make_box(Vec3(0, -20, -3), Vec3(80, 60, 3), {4, 4, 1});
        model.supports = {mesh::BoxRegion{Vec3(-1, -21, -4), Vec3(1, 61, 4)}};
        std::vector<Vec3> forces;
        for (int i = 0; i < 12; ++i) {
            const Eigen::VectorXd f = identify::RandomStream(5, 0, i).normals(3);
            forces.emplace_back(2 * f[0], 2 * f[1], 0.2 * f[2]);
        }
        set = identify::simulate_measurements(identify::with_truth(model, {1.5}, {600}),
                                              identify::push_spheres(model, forces),
                                              identify::markers_on_spheres(model), 0.05);
        set.name = "stream";
        skeleton::write_model(folder / "model.json", model);
        write(6);
    }
    /// The first states, as a set.
    void write(int count) const {
        identify::MeasurementSet part = set;
        part.states.resize(static_cast<std::size_t>(count));
        identify::write_measurement_set(folder / "set", part);
    }
    /// As a program that appends would: loads first, then positions.
    void append(int from, int to) const {
        identify::MeasurementSet part = set;
        part.states.assign(set.states.begin() + from, set.states.begin() + to);
        const TemporaryFolder other;
        identify::write_measurement_set(other / "set", part);
        for (const char* table : {"probes.csv", "positions.csv"}) {
            const std::string text = mesh::read_text(other / "set" / table);
            std::ofstream(folder / "set" / table, std::ios::app)
                << text.substr(text.find("\n", text.find("probe")) + 1);
        }
    }
    /// By "live", which has then read what is there.
    void wait_until_followed(const std::stop_token& gone) const {
        comes_true([&] { return std::filesystem::exists(folder / "live/cloud.json") || gone.stop_requested(); });
    }
    commands::FollowOptions options(const char* output) const {
        commands::FollowOptions how{folder / "model.json", folder / "set", folder / output, false, 2, {}, {}};
        how.how.scope = identify::Scope::uniform;
        how.how.law = identify::LawChoice::large_rotation;
        how.how.fixed = {skeleton::Stiffness::torsion};
        return how;
    }
};

}  // namespace palpate::pipeline
