#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/body/body.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/results/quality.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

std::string extension_of(const std::string& format) { return format.empty() ? ".vtu" : "." + format.substr(0, 3); }

std::string format_named(const fs::path& output) {
    const std::string extension = output.extension().string();
    if (extension == ".vtu" || extension == ".inp" || extension == ".msh") return extension.substr(1);
    throw InvalidInput(
        fmt::format("{}: a body is written as .vtu, .inp or .msh; name the file so, or say --to", output.string()));
}

mesh::SolverSetting solver_setting(const MeshedBody& meshed, const Subject& subject) {
    const auto told = [](const fem::Material& m) { return mesh::SolverMaterial{m.young, m.poisson, m.density}; };
    const fem::Materials materials = materials_of(subject, element_regions(subject, meshed));
    mesh::SolverSetting setting{.held = mesh::contains(subject.supports, meshed.volume.nodes),
                                .material = told(materials.body)};
    for (const fem::Material& region : materials.regions) setting.regions.push_back(told(region));
    setting.region_of_element = materials.of_element;
    return setting;
}

void write_body(const fs::path& output, const std::string& format, const MeshedBody& meshed, const Subject& subject) {
    const mesh::VolumeMesh& body = meshed.volume;
    if (format == "vtu") {
        mesh::write_vtu(output, body, regions_shown(element_regions(subject, meshed)));
    } else if (format == "inp") {
        mesh::write_inp(output, body, solver_setting(meshed, subject));
    } else {
        mesh::write_gmsh(output, body, format == "msh22" ? mesh::GmshVersion::v2_2 : mesh::GmshVersion::v4_1);
    }
}

}  // namespace

BuiltBody build_body(const fs::path& input, const CaseOverrides& overrides) {
    Subject subject = read_subject(read_case(input, overrides));
    Console::notices(subject.notes);
    Console::notices(subject.assumptions);
    MeshedBody body = make_body(
        subject, {.edge_length = subject.settings.edge_length, .linear_elements = subject.settings.linear_elements},
        Console::progress());
    Console::notices(body.notes);
    return {std::move(subject), std::move(body)};
}

Outcome mesh_body(const MeshOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("body" + extension_of(options.format)) : options.output;
    const std::string format = options.format.empty() ? format_named(output) : options.format;
    refuse_to_overwrite(output, common.force);
    const auto [subject, body] = build_body(options.input, options.overrides);
    write_body(output, format, body, subject);
    Outcome outcome;
    const double volume = mesh::element_volumes(body.volume).sum();
    outcome.text = fmt::format("{0}: {1} tetrahedra, {2} nodes, {3:.4g} mm^3.\nNext: paraview {0}\n", output.string(),
                               body.volume.tetrahedra.rows(), body.volume.nodes.rows(), volume);
    outcome.json = {{"file", output.string()},
                    {"tetrahedra", body.volume.tetrahedra.rows()},
                    {"nodes", body.volume.nodes.rows()},
                    {"volume_mm3", volume},
                    {"repair", body.notes}};
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_mesh(CLI::App& app) {
    auto* sub = subcommand(
        app, "mesh", "Repairs, remeshes and fills a surface with tetrahedra.",
        "  palpate mesh liver.stl -o body.vtu --edge-length 8\n  palpate mesh liver.nii.gz --label 3 --to inp\n",
        [this] { return commands::mesh_body(mesh, common); });
    sub->add_option("SURFACE", mesh.input, "A mesh, CAD, a label image, or a case.yaml")->required();
    sub->add_option("-o,--output", mesh.output, "The volume mesh; body.vtu by default");
    sub->add_option("--to", mesh.format,
                    "vtu; inp: Abaqus, CalculiX; msh, msh22: Gmsh 4.1, 2.2; by the output's name by default")
        ->check(CLI::IsMember({"vtu", "inp", "msh", "msh22"}));
    add_flags_of(sub, mesh.overrides, "Body");
}

}  // namespace palpate::pipeline
