#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/body/body.h"
#include "pipeline/body/region_field.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/results/quality.h"
#include "skeleton/construction/build.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// Where quality is written, beside a model: arm.json has arm_quality.json, .csv and .svg.
fs::path quality_file(const fs::path& model, const char* extension) {
    return model.parent_path() / (model.stem().string() + "_quality" + extension);
}

/// Measures a model, writes what comes of it beside the model, and puts it into the outcome.
void add_quality(const Subject& subject, const MeshedBody& body, const skeleton::Model& model, const fs::path& output,
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

BuiltSkeleton build_skeleton(const BuiltBody& from) {
    BuiltSkeleton built;
    built.model = skeleton::build_skeleton(from.body.surface, from.body.volume, from.subject.material,
                                           from.subject.supports, from.subject.settings.skeleton, &built.report);
    built.model.name = from.subject.settings.name;
    Console::notices(built.report.notes);
    Console::notices(take_regions(from.subject.regions, from.subject.material.young, built.model));
    return built;
}

Outcome skeleton(const SkeletonOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("model.json") : options.output;
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
    const BuiltBody built = build_body(options.input, options.overrides);
    const auto& [subject, body] = built;
    const auto [model, report] = build_skeleton(built);
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

namespace palpate::pipeline {

void Subcommands::add_skeleton(CLI::App& app) {
    auto* sub =
        subcommand(app, "skeleton", "Medial axis, spheres, links and skin, with start stiffness from the sections.",
                   "  palpate skeleton liver.stl -o model.json\n  palpate skeleton finger.stl --spheres 12\n"
                   "  palpate skeleton liver.stl -o model.json --quality --quality-spheres 16,64,256\n",
                   [this] {
                       if (with_quality) skeleton.quality = quality;
                       return commands::skeleton(skeleton, common);
                   });
    sub->add_option("INPUT", skeleton.input, "A mesh, a case.yaml, or a measurement set")->required();
    sub->add_option("-o,--output", skeleton.output, "The model; model.json by default");
    add_flags_of(sub, skeleton.overrides, "Body");
    add_flags_of(sub, skeleton.overrides, "Skeleton");
    auto* measured = sub->add_flag("--quality", with_quality,
                                   "Measures how well skeletons follow the body, at several numbers of spheres")
                         ->group("Quality");
    sub->add_option("--quality-spheres", quality.spheres, "These numbers, in place of 8,16,32,64,128,256,512")
        ->delimiter(',')
        ->check(CLI::Range(1, skeleton::BuildOptions::most_spheres))
        ->needs(measured)
        ->group("Quality");
    sub->add_option("--quality-probes", quality.fit, "Probes that are fitted to; 12 more judge")
        ->check(CLI::Range(1, 1000))
        ->needs(measured)
        ->group("Quality");
}

}  // namespace palpate::pipeline
