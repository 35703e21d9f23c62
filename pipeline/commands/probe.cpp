#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "mesh/io/vtk_files.h"
#include "pipeline/case/subject.h"
#include "pipeline/commands/common.h"
#include "pipeline/foreign/deck.h"
#include "pipeline/foreign/foreign_set.h"
#include "pipeline/forge/plan.h"
#include "pipeline/forge/sequence.h"
#include "pipeline/forge/truth.h"
#include "skeleton/model_io.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// What is probed, and how.
struct Probing {
    Specimen specimen;
    ProbeOptions how;
    std::uint64_t seed = 1;
};

/// What is said, on the defaults of probes that are not fitted to at once.
Case probe_settings(const ProbeCommandOptions& options, Case settings) {
    if (!options.say.has("probing.probes")) settings.probing.probes = ProbeOptions{}.probes;
    settings.probing.held_out = 0;
    return settings;
}

Probing probing_of_model(const ProbeCommandOptions& options) {
    Probing probing;
    const Case settings = probe_settings(options, options.say.on_defaults());
    probing.how = settings.probing;
    probing.how.validate();
    probing.seed = settings.identify.seed;
    probing.specimen = skeleton_specimen(skeleton::read_model(options.input), probing.how, options.forge, probing.seed);
    return probing;
}

Probing probing_of_body(const ProbeCommandOptions& options) {
    const Subject subject = read_subject(probe_settings(options, read_case(options.input, options.say)));
    Console::notices(subject.notes);
    Console::notices(subject.assumptions);
    return {finite_element_specimen(subject, options.forge, Console::progress()), subject.settings.probing,
            subject.settings.identify.seed};
}

/// Full fields: node displacements of each state.
void write_fields(const fs::path& folder, const Forged& forged, const mesh::VolumeMesh& body) {
    for (std::size_t s = 0; s < forged.set.states.size(); ++s) {
        const Eigen::VectorXd& q = forged.configurations[s];
        const Eigen::Map<const Points> u(q.data(), q.size() / 3, 3);
        mesh::write_vtu(folder / identify::field_file(forged.set.states[s]), body, {.points = {{"displacement", u}}});
    }
}

std::vector<std::string> names_of(const std::vector<Hidden>& hidden) {
    std::vector<std::string> names;
    names.reserve(hidden.size());
    for (const Hidden& one : hidden) names.push_back(one.effect.name);
    return names;
}

/// What is hidden, in words: never its numbers.
void tell_hidden(const Forged& forged, bool has_fields) {
    for (const Hidden& hidden : forged.hidden) {
        Console::notice(fmt::format("Hidden: {}, which changes the readings by {:.3g} mm rms; the noise is {:.3g} mm.",
                                    hidden.effect.name, hidden.strength.change, forged.noise));
    }
    if (forged.is_blind && has_fields) {
        Console::notice("Neither full fields nor the material are written: they would tell. truth.json does.");
    }
}

/// What another solver computed.
Outcome probe_from(const ProbeCommandOptions& options, const fs::path& output) {
    const Case settings = read_case(options.input, options.say);
    const ForeignOptions how{.folder = options.from,
                             .array = options.array,
                             .faults = {.noise = options.say.on_defaults().probing.noise,
                                        .missing = options.forge.missing,
                                        .unlabelled = options.forge.unlabelled},
                             .seed = settings.identify.seed};
    const ForeignSet foreign = foreign_set(settings, how, Console::progress());
    Console::notices(foreign.notes);
    write_foreign_set(output, foreign);

    const identify::MeasurementSet& set = foreign.set;
    Outcome outcome;
    outcome.text = fmt::format("{}: {} states out of {}, {} markers.\nNext: palpate run {}\n", output.string(),
                               set.states.size(), options.from.string(), set.markers.size(), output.string());
    outcome.json = {{"set", output.string()},
                    {"states", set.states.size()},
                    {"markers", set.markers.size()},
                    {"from", options.from.string()},
                    {"notes", foreign.notes}};
    return outcome;
}

/// What another solver shall compute.
Outcome probe_to(const ProbeCommandOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("deck") : options.output;
    if (fs::exists(output) && !fs::is_directory(output))
        throw InvalidInput(fmt::format("{}: is a file; with --to, -o names a folder.", output.string()));
    for (const char* file : {"body.inp", "probes.csv"}) refuse_to_overwrite(output / file, common.force);
    const Probing probing = probing_of_body(options);
    const Specimen& specimen = probing.specimen;
    const double largest = specimen.model->size() * probing.how.largest_displacement(specimen.in_small_strain());
    const Plan plan = make_plan(specimen, options.forge, sequence_of(options.forge, {}).rhythm, largest, common.threads,
                                Console::progress());
    Console::notices(plan.notes);
    const int states = write_deck(output, specimen, plan);

    Outcome outcome;
    outcome.text = fmt::format(
        "{0}: body.inp with {1} steps, {2} nodes, law '{3}'; probes.csv tells their loads.\n"
        "Next: (cd {0} && ccx body), then palpate probe {4} --from {0} -o measurements\n",
        output.string(), states, specimen.volume.nodes.rows(), specimen.law(), options.input.string());
    outcome.json = {{"deck", (output / "body.inp").string()},
                    {"probes", (output / "probes.csv").string()},
                    {"states", states},
                    {"nodes", specimen.volume.nodes.rows()},
                    {"law", specimen.law()}};
    return outcome;
}

}  // namespace

Outcome probe(const ProbeCommandOptions& options, const Common& common) {
    if (!options.to.empty()) return probe_to(options, common);
    const fs::path output = options.output.empty() ? fs::path("measurements") : options.output;
    refuse_to_overwrite(output, common.force);
    if (!options.from.empty()) return probe_from(options, output);
    ForgeOptions how = options.forge;
    how.validate();
    const bool is_model = options.input.extension() == ".json";
    const Probing probing = is_model ? probing_of_model(options) : probing_of_body(options);
    const Specimen& specimen = probing.specimen;
    if (options.say.has("probing.noise") || probing.how.noise > 0) how.noise = probing.how.noise;

    Console::notices(specimen.notes);
    const Forged forged = forge(specimen, probing.how, how, probing.seed, common.threads, Console::progress());
    Console::notices(forged.notes);
    const bool has_fields = !specimen.is_skeleton();
    tell_hidden(forged, has_fields);
    identify::write_measurement_set(output, forged.set, [&](const fs::path& folder) {
        mesh::write_text(folder / "truth.json", truth_of(forged, specimen, how, probing.seed).dump(2) + "\n");
        if (has_fields && !forged.is_blind) write_fields(folder, forged, specimen.volume);
    });

    Outcome outcome;
    outcome.text =
        fmt::format("{}: {} states of {} by the law '{}', {} markers{}.\n", output.string(), forged.set.states.size(),
                    specimen.is_skeleton() ? "the skeleton itself" : "finite elements", specimen.law(),
                    forged.set.markers.size(), has_fields && !forged.is_blind ? ", with full fields" : "");
    outcome.text += "Next: palpate run " + output.string() + "\n";
    outcome.json = {
        {"set", output.string()}, {"states", forged.set.states.size()}, {"markers", forged.set.markers.size()},
        {"law", specimen.law()},  {"noise_mm", forged.noise},           {"hidden", names_of(forged.hidden)},
        {"notes", forged.notes}};
    return outcome;
}

}  // namespace palpate::pipeline::commands
