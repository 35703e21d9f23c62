#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "mesh/io/vtk_files.h"
#include "mesh/write_volume.h"
#include "pipeline/case/subject.h"
#include "pipeline/commands/common.h"
#include "pipeline/quality/quality_files.h"
#include "pipeline/reference/body.h"
#include "skeleton/model_io.h"

// What makes something from a mesh: a body, a skeleton.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

Body body_of(const Subject& subject, double edge_length) {
    Body body = make_body(subject, {edge_length, subject.settings.linear_elements}, Console::progress());
    Console::notices(body.notes);
    return body;
}

fs::path or_default(const fs::path& said, const std::string& fallback) {
    return said.empty() ? fs::path(fallback) : said;
}

std::string extension_of(const std::string& format) { return format.empty() ? ".vtu" : "." + format.substr(0, 3); }

std::string format_named(const fs::path& output) {
    const std::string extension = output.extension().string();
    if (extension == ".vtu" || extension == ".inp" || extension == ".msh") return extension.substr(1);
    throw InvalidInput(
        fmt::format("{}: a body is written as .vtu, .inp or .msh; name the file so, or say --to", output.string()));
}

void write_body(const fs::path& output, const std::string& format, const mesh::VolumeMesh& body,
                const Subject& subject) {
    if (format == "vtu") {
        mesh::write_vtu(output, body);
    } else if (format == "inp") {
        mesh::write_inp(output, body,
                        {.held = mesh::contains(subject.supports, body.nodes),
                         .young = subject.material.young,
                         .poisson = subject.material.poisson,
                         .density = subject.material.density});
    } else {
        mesh::write_gmsh(output, body, format == "msh22" ? mesh::GmshVersion::v2_2 : mesh::GmshVersion::v4_1);
    }
}

/// Where quality is told, beside a model: arm.json has arm_quality.json, .csv and .svg.
fs::path quality_file(const fs::path& model, const char* extension) {
    return model.parent_path() / (model.stem().string() + "_quality" + extension);
}

/// Measures a model, writes what comes of it beside the model, and tells it in the outcome.
void add_quality(const Subject& subject, const Body& body, const skeleton::Model& model, const fs::path& output,
                 QualityOptions options, int threads, Outcome& outcome) {
    options.threads = threads;
    const Quality quality = measure_quality(subject, body, model, options, Console::progress());
    Console::notices(quality.notes);
    mesh::write_text(quality_file(output, ".json"), quality_json(quality).dump(1) + "\n");
    mesh::write_text(quality_file(output, ".csv"), quality_csv(quality));
    mesh::write_text(quality_file(output, ".svg"), quality_plot(quality, subject.settings.name));
    outcome.text += fmt::format("\n{}Written to {} (.json, .csv, .svg).\n", quality_table(quality),
                                quality_file(output, "").string());
    outcome.json["quality"] = quality_json(quality);
}

}  // namespace

Outcome mesh_body(const MeshOptions& options, const Common& common) {
    const fs::path output = or_default(options.output, "body" + extension_of(options.format));
    const std::string format = options.format.empty() ? format_named(output) : options.format;
    refuse_to_overwrite(output, common.force);
    const Subject subject = read_subject(read_case(options.input, options.say));
    Console::notices(subject.notes);
    Console::notices(subject.assumptions);
    const Body body = body_of(subject, subject.settings.edge_length);
    write_body(output, format, body.volume, subject);
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

Outcome skeleton(const SkeletonOptions& options, const Common& common) {
    const fs::path output = or_default(options.output, "model.json");
    if (output.extension() != ".json") {
        throw InvalidInput(fmt::format("{}: a model is written as .json; name the file so", output.string()));
    }
    refuse_to_overwrite(output, common.force);
    if (options.quality) {
        options.quality->validate();
        for (const char* extension : {".json", ".csv", ".svg"}) {
            refuse_to_overwrite(quality_file(output, extension), common.force);
        }
    }
    const Subject subject = read_subject(read_case(options.input, options.say));
    Console::notices(subject.notes);
    Console::notices(subject.assumptions);
    const Body body = body_of(subject, subject.settings.edge_length);
    skeleton::BuildReport report;
    skeleton::Model model = skeleton::build_skeleton(body.surface, body.volume, subject.material, subject.supports,
                                                     subject.settings.skeleton, &report);
    model.name = subject.settings.name;
    Console::notices(report.notes);
    skeleton::write_model_vtp(fs::path(output).replace_extension(".vtp"), model);
    skeleton::write_model(output, model);
    const auto held = std::count_if(model.spheres.begin(), model.spheres.end(), [](auto& s) { return s.held; });
    Outcome outcome;
    outcome.text =
        fmt::format("{}: {} spheres ({} held), {} links; no surface is further than {:.3g} mm outside the spheres.\n",
                    output.string(), model.spheres.size(), held, model.links.size(), report.coverage);
    outcome.json = {{"file", output.string()},     {"spheres", model.spheres.size()}, {"held", held},
                    {"links", model.links.size()}, {"coverage_mm", report.coverage},  {"notes", report.notes}};
    if (options.quality) add_quality(subject, body, model, output, *options.quality, common.threads, outcome);
    outcome.text += subject.set ? fmt::format("Next: palpate identify {} {} -o identified\n", output.string(),
                                              options.input.string())
                                : fmt::format("Next: palpate probe {} -o measurements\n", options.input.string());
    return outcome;
}

}  // namespace palpate::pipeline::commands
