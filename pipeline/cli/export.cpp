#include <fmt/format.h>

#include "identify/loading/loads.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/words.h"
#include "pipeline/analysis/playback.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/exports/gltf.h"
#include "pipeline/exports/programs.h"
#include "pipeline/output/vtk/series.h"
#include "skeleton/model/io/model_io.h"

// The model for other programs.

namespace palpate::pipeline::commands {
namespace {

/// The model in the states that probes put it in.
struct SimulatedStates {
    std::vector<skeleton::State> states;
    std::vector<Points> displacements;  // of the skin [mm]
};

SimulatedStates play(const skeleton::Model& model, const std::filesystem::path& probes) {
    SimulatedStates played;
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
Points shown(const ExportOptions& options, const skeleton::Model& model, const SimulatedStates& played) {
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
    const SimulatedStates played = play(model, options.probes);
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
    for (std::string& words : left_out) words = mesh::capitalised(words) + ".";
    Console::notices(left_out);
    outcome.json["left_out"] = left_out;
    outcome.text = fmt::format("Written: {}\n", options.output.string());
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_export(CLI::App& app) {
    auto* sub =
        subcommand(app, "export", "The calibrated model for other programs.",
                   "  palpate export model.json --to gltf -o liver.glb        # skinned mesh, spheres as joints\n"
                   "  palpate export model.json --to gltf --probes set/probes.csv -o liver.gltf    # and moving\n"
                   "  palpate export model.json --to stl --probes set/probes.csv --state 3 -o pressed.stl\n"
                   "  palpate export model.json --to sofa -o liver.py\n"
                   "  palpate export model.json --to chai3d -o liver.h\n",
                   [this] { return commands::export_model(exports, common); });
    sub->add_option("MODEL", exports.model, "model.json")->required();
    sub->add_option("--to", exports.to,
                    "gltf (2.0; .glb or .gltf), sofa (a scene in Python), chai3d (C++ for its GEL module), stl, vtp")
        ->required()
        ->check(CLI::IsMember({"gltf", "sofa", "chai3d", "stl", "vtp"}));
    sub->add_option("-o,--output", exports.output, "The file")->required();
    auto* probes = sub->add_option("--probes", exports.probes,
                                   "probes.csv, whose states are played: gltf moves through them, stl and vtp show one")
                       ->type_name("PATH");
    sub->add_option("--state", exports.state, "Which of them stl and vtp show, from 0; the last by default")
        ->check(CLI::NonNegativeNumber)
        ->needs(probes);
}

}  // namespace palpate::pipeline
