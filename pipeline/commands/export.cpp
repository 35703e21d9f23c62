#include <fmt/format.h>

#include "identify/set/loads.h"
#include "mesh/errors.h"
#include "mesh/io/vtk_files.h"
#include "mesh/read_surface.h"
#include "pipeline/commands/common.h"
#include "pipeline/console.h"
#include "pipeline/exports/gltf.h"
#include "pipeline/exports/programs.h"
#include "pipeline/results/series.h"
#include "skeleton/model_io.h"

// The model for other programs.

namespace palpate::pipeline::commands {
namespace {

/// The model in the states that probes put it in.
struct Played {
    std::vector<skeleton::State> states;
    std::vector<Points> displacements;  // of the skin [mm]
};

Played play(const skeleton::Model& model, const std::filesystem::path& probes) {
    Played played;
    if (probes.empty()) return played;
    const identify::ContactLoads to_load(model);
    skeleton::StaticsSolver solver(model);
    const Eigen::VectorXd k = skeleton::stiffness_vector(model);
    for (const identify::LoadState& state : identify::read_probes(probes)) {
        const skeleton::Load load = to_load(state.contacts);
        const skeleton::Equilibrium found = solver.solve(k, load);
        played.states.push_back(found.state);
        played.displacements.push_back(skin_displacement(model, found, load));
    }
    return played;
}

/// The displacement of the state that was asked for; none at rest.
Points shown(const ExportOptions& options, const skeleton::Model& model, const Played& played) {
    if (played.displacements.empty()) return Points::Zero(model.surface.vertices.rows(), 3);
    const int last = static_cast<int>(played.displacements.size()) - 1, state = options.state.value_or(last);
    if (state > last)
        throw InvalidInput(
            fmt::format("--state is {}, but {} has states 0 to {}", state, options.probes.string(), last));
    return played.displacements[state];
}

}  // namespace

Outcome export_model(const ExportOptions& options, const Common& common) {
    refuse_to_overwrite(options.output, common.force);
    const skeleton::Model model = skeleton::read_model(options.model);
    const bool is_surface = options.to == "stl" || options.to == "vtp";
    if (is_surface && model.surface.triangles.rows() == 0)
        throw InvalidInput(options.model.string() + ": has no skin to be written; give the model one");
    const Played played = play(model, options.probes);
    Outcome outcome;
    outcome.json = {{"file", options.output.string()}, {"to", options.to}};
    std::vector<std::string> left_out;
    if (options.to == "gltf") {
        const GltfReport report = write_gltf(options.output, model, played.states);
        outcome.json["skin_error"] = report.skin_error;
        left_out.push_back(fmt::format("the skin follows four spheres a vertex, {:.2g} % of its displacement off",
                                       100 * report.skin_error));
    } else if (options.to == "sofa") {
        left_out = write_sofa(options.output, model);
    } else if (options.to == "chai3d") {
        left_out = write_chai3d(options.output, model);
    } else {
        const Points u = shown(options, model, played);
        if (options.to == "vtp") {
            mesh::write_vtp(options.output, model.surface, {.points = {{"displacement [mm]", u}}});
        } else {
            mesh::Surface surface = model.surface;
            surface.vertices += u;
            mesh::write_surface(options.output, surface);
        }
    }
    for (std::string& words : left_out) {
        words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
        words += ".";
    }
    Console::notices(left_out);
    outcome.json["left_out"] = left_out;
    outcome.text = fmt::format("Written: {}\n", options.output.string());
    return outcome;
}

}  // namespace palpate::pipeline::commands
