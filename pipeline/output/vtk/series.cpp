#include "pipeline/output/vtk/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "fem/interpolation/interpolation.h"
#include "identify/measurements/field.h"
#include "pipeline/analysis/playback.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

std::string step_name(const std::string& name, std::size_t step) { return fmt::format("{}_{:03}.vtp", name, step); }

/// Displacement of the skin in a full field.
std::optional<Points> field_on_skin(const skeleton::Model& model, const identify::LoadState& state) {
    if (state.field.empty()) return std::nullopt;
    const identify::Field field = identify::read_field(state);
    return Points(fem::interpolation(field.mesh, model.surface.vertices) * field.displacement);
}

/// Columns of the particle matrix of one kind of stiffness, in order.
std::vector<int> columns_of(const identify::IdentifyResult& result, const std::string& kind) {
    std::vector<int> columns;
    for (std::size_t p = 0; p < result.posterior.size(); ++p) {
        const std::string& name = result.posterior[p].parameter;
        if (name.substr(0, name.find(':')) == kind) columns.push_back(static_cast<int>(p));
    }
    return columns;
}

void write_skin(const fs::path& file, const skeleton::Model& model, const identify::LoadState& state,
                const identify::ReducedLoadEquilibrium& played) {
    const Points u = skin_displacement(model, played.equilibrium, played.load);
    mesh::MeshData data{.points = {{"displacement [mm]", u}}};
    if (const auto measured = field_on_skin(model, state)) {
        data.points.push_back({"measured [mm]", *measured});
        data.points.push_back({"error [mm]", *measured - u});
    }
    mesh::write_vtp(file, model.surface, data);
}

void write_spheres(const fs::path& file, const skeleton::Model& model, const identify::LoadState& state,
                   const identify::ReducedLoadEquilibrium& played) {
    const Points u = played.equilibrium.state.x - skeleton::rest_state(model).x;
    skeleton::write_model_vtp(file, model,
                              {.points = {{"displacement [mm]", u},
                                          {"probe", Eigen::VectorXd::Constant(u.rows(), state.probe)},
                                          {"time [s]", Eigen::VectorXd::Constant(u.rows(), state.time)}}});
}

void write_loads(const fs::path& file, const identify::LoadState& state) {
    const auto count = static_cast<Eigen::Index>(state.contacts.size());
    Points points(count, 3), forces(count, 3);
    for (Eigen::Index c = 0; c < count; ++c) {
        points.row(c) = state.contacts[c].point;
        forces.row(c) = state.contacts[c].force;
    }
    mesh::write_vtp_lines(file, points, {}, {.points = {{"force [N]", forces}}});
}

}  // namespace

MarkerState marker_state(const identify::MeasurementSet& set, const identify::Comparison& comparison,
                         std::size_t state) {
    const auto& readings = set.states[state].readings;
    std::vector<int> labelled;
    for (int r = 0; r < static_cast<int>(readings.size()); ++r)
        if (is_usable(readings[r])) labelled.push_back(r);
    const auto count = static_cast<Eigen::Index>(labelled.size());
    Points measured(count, 3), rest(count, 3), predicted(count, 3);
    Eigen::VectorXd ids(count), coordinates(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const identify::Reading& reading = readings[labelled[i]];
        const identify::Marker& marker = set.markers[reading.marker];
        predicted.row(i) = comparison.predicted[state].row(labelled[i]);
        const auto is_read = !reading.position.array().isNaN();
        measured.row(i) = is_read.select(reading.position.array(), predicted.row(i).transpose().array()).transpose();
        coordinates[i] = static_cast<double>(is_read.count());
        rest.row(i) = marker.rest;
        ids[i] = marker.id;
    }
    return {measured,
            {.points = {{"error [mm]", measured - predicted},
                        {"displacement [mm]", predicted - rest},
                        {"measured [mm]", measured - rest},
                        {"marker", ids},
                        {"coordinates", coordinates}}}};
}

void write_marker_series(const fs::path& folder, const std::string& name, const identify::MeasurementSet& set,
                         const identify::Comparison& comparison) {
    std::vector<mesh::SeriesStep> steps;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const MarkerState markers = marker_state(set, comparison, s);
        const fs::path file = folder / step_name(name, s);
        mesh::write_vtp_lines(file, markers.measured, {}, markers.data);
        steps.push_back({static_cast<double>(s), file});
    }
    mesh::write_pvd(folder / (name + ".pvd"), steps);
}

void write_played_series(const fs::path& folder, const skeleton::Model& model, const identify::MeasurementSet& set,
                         const identify::Comparison& comparison) {
    write_marker_series(folder, "markers", set, comparison);
    const std::vector<identify::ReducedLoadEquilibrium> played = play(model, set);
    std::vector<mesh::SeriesStep> skin, spheres, loads;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const auto step = [&](const char* name) {
            return mesh::SeriesStep{static_cast<double>(s), folder / step_name(name, s)};
        };
        skin.push_back(step("skin"));
        write_skin(skin.back().file, model, set.states[s], played[s]);
        spheres.push_back(step("skeleton"));
        write_spheres(spheres.back().file, model, set.states[s], played[s]);
        loads.push_back(step("loads"));
        write_loads(loads.back().file, set.states[s]);
    }
    mesh::write_pvd(folder / "skin.pvd", skin);
    mesh::write_pvd(folder / "skeleton.pvd", spheres);
    mesh::write_pvd(folder / "loads.pvd", loads);
}

void write_particle_series(const fs::path& file, const identify::IdentifyResult& result) {
    const std::vector<int> elongation = columns_of(result, "elongation"), flexion = columns_of(result, "flexion");
    constexpr std::size_t most_groups = 64;  // a plane for each of hundreds of links is no picture
    const std::size_t groups = std::min({elongation.size(), flexion.size(), most_groups});
    std::vector<mesh::SeriesStep> steps;
    const double widest = result.history.empty() ? 1.0 : [&] {
        double e = 0, f = 0;
        for (std::size_t g = 0; g < groups; ++g) {
            e = std::max(e, result.history.front().particles.col(elongation[g]).maxCoeff());
            f = std::max(f, result.history.front().particles.col(flexion[g]).maxCoeff());
        }
        return f > 0 ? e / f : 1.0;
    }();
    for (std::size_t h = 0; h < result.history.size(); ++h) {
        const identify::FilterStep& step = result.history[h];
        const Eigen::Index m = step.particles.rows();
        const Eigen::Index count = m * static_cast<Eigen::Index>(groups);
        Points points(count, 3);
        Eigen::VectorXd kE(count), kF(count), zone(count), weight(count);
        for (std::size_t g = 0; g < groups; ++g) {
            const auto rows = Eigen::seqN(static_cast<Eigen::Index>(g) * m, m);
            kE(rows) = step.particles.col(elongation[g]);
            kF(rows) = step.particles.col(flexion[g]);
            zone(rows).setConstant(static_cast<double>(g));
            weight(rows) = step.log_weights.array().exp();
        }
        points << kE, kF * widest, zone;
        const fs::path vtp = file.parent_path() / file.stem() / step_name("particles", h);
        mesh::write_vtp_lines(
            vtp, points, {},
            {.points = {
                 {"elongation [N/mm]", kE}, {"flexion [N*mm/rad]", kF}, {"zone", zone}, {"weight [-]", weight}}});
        steps.push_back({static_cast<double>(h), vtp});
    }
    mesh::write_pvd(file, steps);
}

}  // namespace palpate::pipeline
