// What the command does is in probe.cpp.

#include "pipeline/command_line/flags.h"
#include "fem/large_deformation/material_law_names.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/synthesis/effects/effect_spec.h"

namespace palpate::pipeline {
namespace {

void add_law_flags(CLI::App* command, BlindSetOptions& synthesis) {
    auto* law = command->add_option_function<std::string>(
        "--law", [&](const std::string& name) { synthesis.law = fem::material_law(name); },
        "The body's law in large deformation: neo-hooke (by default), svk; linear: small strain");
    law->check(CLI::IsMember(fem::material_law_choices()))->group("Body");
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
                     "An effect that the set does not state ('palpate effects' lists them), EFFECT[:name=value,...];\n"
                     "what is not given is drawn, strong enough to be seen. Repeatable; 'none' hides nothing")
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
                   "State the material in the set, though something is hidden")
        ->group("Truth");
}

void add_solver_flags(CLI::App* command, commands::ProbeCommandOptions& probe) {
    auto* from = command
                     ->add_option("--from", probe.from,
                                  "Take the fields of another solver: a folder of .frd, .dat (CalculiX), .vtu or .vtp\n"
                                  "files, and a probes.csv or the .inp file with the loads")
                     ->type_name("PATH");
    from->group("Another solver");
    command
        ->add_option("--array", probe.array,
                     "Point array of displacements in .vtu and .vtp files; by default the\n"
                     "one that has this name")
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
                   "  palpate probe liver.stl -o blind --hide gravity          # what is missing? truth.json holds it\n"
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
