#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/case/region_spec.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/synthesis/external_solver/solver_set.h"
#include "pipeline/synthesis/external_solver/write_deck.h"
#include "pipeline/synthesis/loading/load_plan.h"
#include "pipeline/synthesis/loading/load_sequence.h"
#include "pipeline/synthesis/truth.h"
#include "skeleton/model/io/model_io.h"

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
    if (!options.overrides.has("probing.probes")) settings.probing.probes = ProbeOptions{}.probes;
    settings.probing.held_out = 0;
    return settings;
}

Probing probing_of_model(const ProbeCommandOptions& options) {
    Probing probing;
    const Case settings = probe_settings(options, options.overrides.on_defaults());
    probing.how = settings.probing;
    probing.how.validate();
    probing.seed = settings.identify.seed;
    probing.specimen =
        skeleton_specimen(skeleton::read_model(options.input), probing.how, options.synthesis, probing.seed);
    return probing;
}

/// The case with the regions that flags add.
Case with_regions(const ProbeCommandOptions& options, Case settings) {
    if (!options.regions.empty() && !settings.mesh)
        throw InvalidInput("--region states what a mesh is made of; a measurement set states its regions itself");
    for (const std::string& spec : options.regions) {
        mesh::MaterialRegion region = read_region_spec(spec);
        if (std::ranges::find(settings.regions, region.name, &mesh::MaterialRegion::name) != settings.regions.end())
            throw InvalidInput(
                fmt::format("--region: {} is the name of two regions; each needs its own", mesh::cited(region.name)));
        settings.regions.push_back(std::move(region));
    }
    return settings;
}

Probing probing_of_body(const ProbeCommandOptions& options) {
    const Subject subject =
        read_subject(with_regions(options, probe_settings(options, read_case(options.input, options.overrides))));
    Console::notices(subject.notes);
    Console::notices(subject.assumptions);
    return {finite_element_specimen(subject, options.synthesis, Console::progress()), subject.settings.probing,
            subject.settings.identify.seed};
}

/// Full fields: node displacements of each state.
void write_fields(const fs::path& folder, const BlindSet& blind_set, const mesh::VolumeMesh& body) {
    for (std::size_t s = 0; s < blind_set.set.states.size(); ++s) {
        const Eigen::VectorXd& q = blind_set.configurations[s];
        const Eigen::Map<const Points> u(q.data(), q.size() / 3, 3);
        mesh::write_vtu(folder / identify::field_file(blind_set.set.states[s]), body,
                        {.points = {{"displacement", u}}});
    }
}

std::vector<std::string> names_of(const std::vector<HiddenEffect>& hidden) {
    std::vector<std::string> names;
    names.reserve(hidden.size());
    for (const HiddenEffect& one : hidden) names.push_back(one.effect.name);
    return names;
}

/// What is hidden, in words: never its numbers.
void describe_hidden(const BlindSet& blind_set, bool has_fields) {
    const char* const unit = blind_set.set.markers.empty() ? "N" : "mm";
    for (const HiddenEffect& hidden : blind_set.hidden) {
        Console::notice(
            fmt::format("Hidden: {0}, which changes the readings by {1:.3g} {3} rms; the noise is {2:.3g} {3}.",
                        hidden.effect.name, hidden.strength.change, blind_set.noise, unit));
    }
    if (blind_set.is_blind && has_fields) {
        Console::notice(
            "The set is blind: neither full fields nor the material are written, which would disclose what is hidden. "
            "truth.json holds it.");
    }
}

/// What another solver computed.
Outcome probe_from(const ProbeCommandOptions& options, const fs::path& output) {
    const Case settings = with_regions(options, read_case(options.input, options.overrides));
    const ForeignOptions how{.folder = options.from,
                             .array = options.array,
                             .faults = {.noise = options.overrides.on_defaults().probing.noise,
                                        .missing = options.synthesis.missing,
                                        .unlabelled = options.synthesis.unlabelled},
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
    const Plan plan =
        make_plan(specimen, sequence_of(options.synthesis, {}), largest, common.threads, Console::progress());
    Console::notices(plan.notes);
    const int states = write_deck(output, specimen, plan);

    Outcome outcome;
    outcome.text = fmt::format(
        "{0}: body.inp with {1} steps, {2} nodes, law '{3}'; probes.csv contains their loads.\n"
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
    BlindSetOptions how = options.synthesis;
    how.validate();
    const bool is_model = options.input.extension() == ".json";
    const Probing probing = is_model ? probing_of_model(options) : probing_of_body(options);
    const Specimen& specimen = probing.specimen;
    if (options.overrides.has("probing.noise") || probing.how.noise > 0) how.noise = probing.how.noise;

    Console::notices(specimen.notes);
    const BlindSet blind_set =
        synthesise(specimen, probing.how, how, probing.seed, common.threads, Console::progress());
    Console::notices(blind_set.notes);
    const bool has_fields = !specimen.is_skeleton();
    describe_hidden(blind_set, has_fields);
    identify::write_measurement_set(output, blind_set.set, [&](const fs::path& folder) {
        mesh::write_text(folder / "truth.json", truth_of(blind_set, specimen, how, probing.seed).dump(2) + "\n");
        if (has_fields && !blind_set.is_blind) write_fields(folder, blind_set, specimen.volume);
    });

    Outcome outcome;
    outcome.text = fmt::format(
        "{}: {} states of {} by the law '{}', {} markers{}.\n", output.string(), blind_set.set.states.size(),
        specimen.is_skeleton() ? "the skeleton itself" : "finite elements", specimen.law(),
        blind_set.set.markers.size(), has_fields && !blind_set.is_blind ? ", with full fields" : "");
    outcome.text += "Next: palpate run " + output.string() + "\n";
    outcome.json = {{"set", output.string()},
                    {"states", blind_set.set.states.size()},
                    {"markers", blind_set.set.markers.size()},
                    {"law", specimen.law()},
                    {blind_set.set.markers.empty() ? "noise_n" : "noise_mm", blind_set.noise},
                    {"hidden", names_of(blind_set.hidden)},
                    {"notes", blind_set.notes}};
    return outcome;
}

}  // namespace palpate::pipeline::commands
