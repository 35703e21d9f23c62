#include <fmt/format.h>

#include <algorithm>

#include "fem/elastic_body.h"
#include "mesh/errors.h"
#include "mesh/io/vtk_files.h"
#include "pipeline/case/subject.h"
#include "pipeline/commands/common.h"
#include "pipeline/reference/body.h"
#include "pipeline/reference/probing.h"
#include "pipeline/reference/twin_probing.h"
#include "skeleton/model_io.h"

// What makes something from a mesh: a body, a skeleton, measurements.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

void tell(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) Console::notice(line);
}

Body body_of(const Subject& subject, double edge_length) {
    Body body = make_body(subject.surface, {edge_length, subject.settings.linear_elements}, Console::progress());
    tell(body.notes);
    return body;
}

fs::path or_default(const fs::path& said, const std::string& fallback) {
    return said.empty() ? fs::path(fallback) : said;
}

Outcome probe_model(const ProbeCommandOptions& options, const fs::path& output) {
    const skeleton::Model model = skeleton::read_model(options.input);
    ProbeOptions how{.displacement = 0.05};
    if (options.say.probes) how.probes = *options.say.probes;
    if (options.say.noise) how.noise = *options.say.noise;
    const identify::MeasurementSet set = probe_twin(model, how, options.say.seed.value_or(1));
    identify::write_measurement_set(output, set);
    Outcome outcome;
    outcome.text = fmt::format("{}: {} states of the skeleton itself, {} markers.\n", output.string(),
                               set.states.size(), set.markers.size());
    outcome.json = {{"set", output.string()}, {"states", set.states.size()}, {"markers", set.markers.size()}};
    return outcome;
}

}  // namespace

Outcome mesh_body(const MeshOptions& options, const Common& common) {
    const fs::path output = or_default(options.output, "body.vtu");
    if (output.extension() != ".vtu") {
        throw InvalidInput(fmt::format("{}: a body is written as .vtu; name the file so", output.string()));
    }
    refuse_to_overwrite(output, common.force);
    const Subject subject = read_subject(read_case(options.input, options.say));
    tell(subject.assumptions);
    const Body body = body_of(subject, subject.settings.edge_length);
    mesh::write_vtu(output, body.volume);
    Outcome outcome;
    const double volume = mesh::element_volumes(body.volume).sum();
    outcome.text = fmt::format("{}: {} tetrahedra, {} nodes, {:.4g} mm^3.\n", output.string(),
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
    const Subject subject = read_subject(read_case(options.input, options.say));
    tell(subject.assumptions);
    const Body body = body_of(subject, subject.settings.edge_length);
    skeleton::BuildReport report;
    skeleton::Model model = skeleton::build_skeleton(body.surface, body.volume, subject.material, subject.supports,
                                                     subject.settings.skeleton, &report);
    model.name = subject.settings.name;
    tell(report.notes);
    skeleton::write_model_vtp(fs::path(output).replace_extension(".vtp"), model);
    skeleton::write_model(output, model);
    const auto held = std::count_if(model.spheres.begin(), model.spheres.end(), [](auto& s) { return s.held; });
    Outcome outcome;
    outcome.text =
        fmt::format("{}: {} spheres ({} held), {} links; no surface is further than {:.3g} mm outside the spheres.\n",
                    output.string(), model.spheres.size(), held, model.links.size(), report.coverage);
    outcome.json = {{"file", output.string()},     {"spheres", model.spheres.size()}, {"held", held},
                    {"links", model.links.size()}, {"coverage_mm", report.coverage},  {"notes", report.notes}};
    return outcome;
}

Outcome probe(const ProbeCommandOptions& options, const Common& common) {
    const fs::path output = or_default(options.output, "measurements");
    refuse_to_overwrite(output, common.force);
    if (options.input.extension() == ".json") return probe_model(options, output);

    Case settings = read_case(options.input, options.say);
    if (!options.say.probes) settings.probing.probes = ProbeOptions{}.probes;
    const Subject subject = read_subject(settings);
    tell(subject.assumptions);
    Console::notice("The reference is linear elasticity in small strain.");
    // Another mesh than the one that fits: a finer one, so that its error is not the reference's.
    constexpr double finer = 0.8;
    const double longest = mesh::bounding_box(subject.surface.vertices).longest_side();
    const double edge = settings.edge_length > 0 ? settings.edge_length : finer * default_edge_share * longest;
    const Body body = body_of(subject, edge);
    const fem::ElasticBody elastic(body.volume, subject.material, mesh::contains(subject.supports, body.volume.nodes),
                                   {.threads = common.threads});
    ProbedBody probed = probe_body(elastic, body.surface, subject.supports, settings.probing, settings.identify.seed,
                                   Console::progress());
    probed.set.name = settings.name;
    write_probed_body(output, probed, body.volume);
    Outcome outcome;
    outcome.text = fmt::format("{}: {} states, {} markers, with full fields.\n", output.string(),
                               probed.set.states.size(), probed.set.markers.size());
    outcome.json = {
        {"set", output.string()}, {"states", probed.set.states.size()}, {"markers", probed.set.markers.size()}};
    return outcome;
}

}  // namespace palpate::pipeline::commands
