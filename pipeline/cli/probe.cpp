#include <fmt/format.h>
#include <algorithm>
#include <map>

#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/case/read_case.h"
#include "pipeline/case/region_spec.h"
#include "pipeline/case/subject.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/synthesis/effects/effect_spec.h"
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
        throw InvalidInput("--region tells what a mesh is made of; a measurement set tells its regions itself");
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
    const bool forces_alone = blind_set.set.markers.empty();
    const double noise = forces_alone ? blind_set.set.reaction_noise.value_or(0) : blind_set.noise;
    for (const HiddenEffect& hidden : blind_set.hidden) {
        Console::notice(
            fmt::format("Hidden: {0}, which changes the readings by {1:.3g} {3} rms; the noise is {2:.3g} {3}.",
                        hidden.effect.name, hidden.strength.change, noise, forces_alone ? "N" : "mm"));
    }
    if (blind_set.is_blind && has_fields) {
        Console::notice(
            "The set is blind: neither full fields nor the material are written, which would disclose what is hidden; "
            "truth.json tells it.");
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
    outcome.json = {
        {"set", output.string()},  {"states", blind_set.set.states.size()}, {"markers", blind_set.set.markers.size()},
        {"law", specimen.law()},   {"noise_mm", blind_set.noise},           {"hidden", names_of(blind_set.hidden)},
        {"notes", blind_set.notes}};
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {
namespace {

const std::map<std::string, fem::MaterialLaw> laws{
    {"linear", fem::MaterialLaw::linear}, {"svk", fem::MaterialLaw::svk}, {"neo-hooke", fem::MaterialLaw::neo_hookean}};

void add_law_flags(CLI::App* command, BlindSetOptions& synthesis) {
    auto* law = command->add_option_function<std::string>(
        "--law", [&](const std::string& name) { synthesis.law = laws.at(name); },
        "The body's law in large deformation: neo-hooke (by default), svk; linear: small strain");
    law->check(CLI::IsMember({"linear", "svk", "neo-hooke"}))->group("Body");
    command
        ->add_flag_callback(
            "--linear", [&] { synthesis.law = fem::MaterialLaw::linear; }, "The same as --law linear")
        ->excludes(law)
        ->group("Body");
}

void add_sequence_flags(CLI::App* command, BlindSetOptions& synthesis) {
    const auto add = [&](const char* name, std::optional<bool>& choice, bool value, const char* what) {
        return command
            ->add_flag_callback(
                name, [&choice, value] { choice = value; }, what)
            ->group("Probing");
    };
    command
        ->add_option("--levels", synthesis.levels,
                     "Loads that each probe presses with; by default one, 1/3, 2/3 and all of the displacement in turn")
        ->check(CLI::Range(1, 100))
        ->group("Probing");
    auto* unload = add("--unload", synthesis.unload, true, "Let the body go after each load, and read it");
    add("--no-unload", synthesis.unload, false, "Do not, though a hidden effect needs it")->excludes(unload);
    auto* back = add("--back", synthesis.back, true, "Go back through the loads of each probe, and let the body go");
    add("--no-back", synthesis.back, false, "Do not, though a hidden effect needs it")->excludes(back);
    command->add_option("--dwell", synthesis.dwell, "Read each held load so long after it was put on, T1,T2,... [s]")
        ->delimiter(',')
        ->check(CLI::PositiveNumber)
        ->group("Probing");
    auto* continuous = add("--continuous", synthesis.continuous, true, "One body goes through all probes");
    add("--no-continuous", synthesis.continuous, false,
        "Each probe finds it as new, though a hidden effect needs the other")
        ->excludes(continuous);
}

void add_rig_flags(CLI::App* command, RigOptions& rig) {
    const auto list = [&](const char* name, std::vector<double>& values, const char* what) {
        command->add_option(name, values, what)->delimiter(',')->check(CLI::PositiveNumber)->group("Rig");
    };
    const auto repeatable = [&](const char* name, std::vector<std::string>& values, const char* what) {
        command->add_option(name, values, what)
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->group("Rig");
    };
    command
        ->add_option("--tool", rig.tool,
                     "Move a rigid tool in place of pressing with forces, and read its reaction:\n"
                     "sphere:radius=5 or flat:radius=4 [mm], at --probes places")
        ->group("Rig");
    list("--depth", rig.depth, "How far it is pressed in, D1,D2,... [mm]");
    list("--pressure", rig.pressure, "Set closed cavities to P1,P2,... [MPa], a probe each");
    repeatable("--cavity", rig.cavity,
               "x,y,z [mm]: the cavity nearest to it; by default that nearest to the middle. Repeatable");
    repeatable("--tendon", rig.tendon,
               "\"x,y,z x,y,z ...\" [mm]: a cable through the body, fixed at its last point. Repeatable");
    list("--tension", rig.tension, "Pull it with T1,T2,... [N], a probe each");
    list("--pull", rig.pull, "Or draw in so much of it, L1,L2,... [mm]");
    command->add_option("--reaction-noise", rig.reaction_noise, "Standard deviation of the tool's force [N]")
        ->check(CLI::NonNegativeNumber)
        ->group("Rig");
    command
        ->add_flag_callback(
            "--no-markers", [&] { rig.markers = false; },
            "No camera sees markers: the tool's force is all that is read")
        ->group("Rig");
}

void add_fault_flags(CLI::App* command, BlindSetOptions& synthesis) {
    command
        ->add_option("--hide", synthesis.hide,
                     "An effect that the set does not tell ('palpate effects' lists them), EFFECT[:name=value,...];\n"
                     "what is not told is drawn, strong enough to be seen. Repeatable; 'none' hides nothing")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(CLI::Validator([](std::string& spec) { return objection_to_spec(spec); }, "EFFECT[:name=value,...]"))
        ->group("Truth");
    command->add_option("--missing", synthesis.missing, "Share of the readings that are left out")
        ->check(CLI::Range(0.0, 0.9))
        ->group("Truth");
    command->add_option("--unlabelled", synthesis.unlabelled, "Share of unlabelled readings")
        ->check(CLI::Range(0.0, 1.0))
        ->group("Truth");
    command
        ->add_flag("--tell-material", synthesis.include_material,
                   "Tell the material in the set, though something is hidden")
        ->group("Truth");
}

void add_solver_flags(CLI::App* command, commands::ProbeCommandOptions& probe) {
    auto* from =
        command->add_option("--from", probe.from,
                            "Take the fields of another solver: a folder of .frd, .dat (CalculiX), .vtu or .vtp\n"
                            "files, and a probes.csv or the .inp file with the loads");
    from->group("Another solver");
    command
        ->add_option("--array", probe.array,
                     "Point array of displacements in .vtu and .vtp files; by default the\n"
                     "one that is called so")
        ->needs(from)
        ->group("Another solver");
    auto* to = command->add_option("--to", probe.to,
                                   "Write what is to be computed, in place of computing it: body.inp for Abaqus or\n"
                                   "CalculiX, a step for each state, and probes.csv");
    to->check(CLI::IsMember({"inp"}))->excludes(from)->group("Another solver");
    for (const char* own :
         {"--hide", "--law", "--linear", "--levels", "--unload", "--no-unload", "--back", "--no-back", "--dwell",
          "--continuous", "--no-continuous", "--probes", "--displacement", "--tell-material", "--edge-length",
          "--linear-elements", "--tool", "--pressure", "--tendon"})
        from->excludes(command->get_option(own));
    for (const char* own : {"--hide", "--noise", "--missing", "--unlabelled", "--dwell", "--unload", "--back",
                            "--continuous", "--tool", "--pressure", "--tendon"})
        to->excludes(command->get_option(own));
}

}  // namespace

void Subcommands::add_probe(CLI::App& app) {
    auto* sub =
        subcommand(app, "probe", "Reference deformations under probing forces, as a measurement set.",
                   "  palpate probe liver.stl -o set --noise 0.05\n"
                   "  palpate probe liver.stl -o blind --hide gravity          # what is missing? truth.json tells\n"
                   "  palpate probe liver.stl -o blind --hide inclusion:ratio=8,radius=12 --hide misalignment\n"
                   "  palpate probe finger.stl -o creep --hide viscosity --dwell 0.1,2,10 --unload\n"
                   "  palpate probe liver.stl -o press --tool sphere:radius=5 --depth 0.5,1,2 --hide inclusion\n"
                   "  palpate probe finger.stl -o inflate --pressure 0.005,0.01,0.02 --hide gravity\n"
                   "  palpate probe liver.stl -o null --hide none --seed 7      # nothing is hidden\n"
                   "  palpate probe finger.stl -o set --region bone:surface=bone.stl,young=20 --hide none\n"
                   "  palpate probe model.json -o twin        # the skeleton itself is the hidden truth\n"
                   "  palpate probe liver.stl --to inp -o deck    # for your own solver; then (cd deck && ccx body)\n"
                   "  palpate probe liver.stl --from deck -o set  # and what it computed\n",
                   [this] {
                       probe.overrides.seed = common.seed;
                       return commands::probe(probe, common);
                   });
    sub->add_option("INPUT", probe.input, "A mesh, a case.yaml, a measurement set, or a model.json")->required();
    sub->add_option("-o,--output", probe.output, "The set's folder; measurements by default");
    add_flags_of(sub, probe.overrides, "Body");
    sub->add_option("--region", probe.regions,
                    "A part of another material, bonded: NAME:surface=FILE,young=MPA[,poisson=NU][,density=KG_M3];\n"
                    "FILE a closed surface inside the body, in the mesh's unit; or NAME:label=N,... of the mesh's own\n"
                    "labels. Repeatable")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group("Body");
    add_law_flags(sub, probe.synthesis);
    add_flags_of(sub, probe.overrides, "Probing");
    add_sequence_flags(sub, probe.synthesis);
    add_rig_flags(sub, probe.synthesis.rig);
    add_fault_flags(sub, probe.synthesis);
    add_solver_flags(sub, probe);
}

}  // namespace palpate::pipeline
