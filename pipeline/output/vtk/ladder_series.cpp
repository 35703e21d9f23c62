#include "pipeline/output/vtk/ladder_series.h"

#include <fmt/format.h>

#include "mesh/formats/vtk/vtk_files.h"
#include "pipeline/output/vtk/series.h"

namespace palpate::pipeline {
namespace {

/// One matrix under the other.
Eigen::MatrixXd stacked(const std::vector<mesh::MeshData>& parts, std::size_t array) {
    Eigen::Index rows = 0;
    for (const mesh::MeshData& part : parts) rows += part.points[array].values.rows();
    Eigen::MatrixXd all(rows, parts.front().points[array].values.cols());
    Eigen::Index row = 0;
    for (const mesh::MeshData& part : parts) {
        const Eigen::MatrixXd& values = part.points[array].values;
        all.middleRows(row, values.rows()) = values;
        row += values.rows();
    }
    return all;
}

/// All states of a step as one cloud of markers.
void write_step(const std::filesystem::path& file, const identify::LadderStep& step) {
    std::vector<Points> places;
    std::vector<mesh::MeshData> parts;
    Eigen::Index count = 0;
    for (std::size_t s = 0; s < step.set.states.size(); ++s) {
        MarkerState markers = marker_state(step.set, step.comparison, s);
        const Eigen::Index n = markers.measured.rows();
        markers.data.points.push_back({"probe", Eigen::VectorXd::Constant(n, step.set.states[s].probe)});
        markers.data.points.push_back({"time", Eigen::VectorXd::Constant(n, step.set.states[s].time)});
        count += n;
        places.push_back(markers.measured);
        parts.push_back(markers.data);
    }
    Points measured(count, 3);
    Eigen::Index row = 0;
    for (const Points& some : places) {
        measured.middleRows(row, some.rows()) = some;
        row += some.rows();
    }
    mesh::MeshData data;
    for (std::size_t array = 0; array < parts.front().points.size(); ++array) {
        data.points.push_back({parts.front().points[array].name, stacked(parts, array)});
    }
    mesh::write_vtp_lines(file, measured, {}, data);
}

/// The state that the first step errs most in; the first one where none was read.
std::size_t worst_state(const identify::LadderStep& step) {
    std::size_t worst = 0;
    double most = -1;
    for (const identify::ProbeError& error : step.comparison.probes) {
        for (std::size_t s = 0; s < step.set.states.size(); ++s) {
            const identify::LoadState& state = step.set.states[s];
            if (state.probe != error.probe || state.time != error.time || !(error.rms > most)) continue;
            most = error.rms;
            worst = s;
        }
    }
    return worst;
}

}  // namespace

void write_ladder_series(const std::filesystem::path& folder, const identify::Ladder& ladder) {
    std::vector<mesh::SeriesStep> steps;
    for (std::size_t i = 0; i < ladder.steps.size(); ++i) {
        const std::filesystem::path file = folder / fmt::format("ladder_{:03}.vtp", i);
        write_step(file, ladder.steps[i]);
        steps.push_back({static_cast<double>(i), file});
    }
    mesh::write_pvd(folder / "ladder.pvd", steps);

    // One state, step by step: of files that the steps' own series hold.
    const std::size_t state = worst_state(ladder.steps.front());
    for (const char* part : {"skin", "markers"}) {
        std::vector<mesh::SeriesStep> of_state;
        for (std::size_t i = 0; i < ladder.steps.size(); ++i)
            of_state.push_back({static_cast<double>(i),
                                folder / fmt::format("step_{}", i) / fmt::format("{}_{:03}.vtp", part, state)});
        mesh::write_pvd(folder / fmt::format("ladder_{}.pvd", part), of_state);
    }
}

}  // namespace palpate::pipeline
