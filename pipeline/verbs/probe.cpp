#include <map>

#include "pipeline/forge/wish.h"
#include "pipeline/verbs/flags.h"
#include "pipeline/verbs/verbs.h"

// The verb that makes measurements.

namespace palpate::pipeline {
namespace {

const std::map<std::string, fem::Law> laws{
    {"linear", fem::Law::linear}, {"svk", fem::Law::svk}, {"neo-hooke", fem::Law::neo_hooke}};

void add_law_flags(CLI::App* verb, ForgeOptions& forge) {
    auto* law = verb->add_option_function<std::string>(
        "--law", [&](const std::string& name) { forge.law = laws.at(name); },
        "The body's law in large deformation: neo-hooke (by default), svk; linear: small strain");
    law->check(CLI::IsMember({"linear", "svk", "neo-hooke"}))->group("Body");
    verb->add_flag_callback(
            "--linear", [&] { forge.law = fem::Law::linear; }, "The same as --law linear")
        ->excludes(law)
        ->group("Body");
}

void add_sequence_flags(CLI::App* verb, ForgeOptions& forge) {
    const auto add = [&](const char* name, std::optional<bool>& choice, bool value, const char* what) {
        return verb
            ->add_flag_callback(
                name, [&choice, value] { choice = value; }, what)
            ->group("Probing");
    };
    verb->add_option("--levels", forge.levels,
                     "Loads that each probe presses with; by default one, 1/3, 2/3 and all of the displacement in turn")
        ->check(CLI::Range(1, 100))
        ->group("Probing");
    auto* unload = add("--unload", forge.unload, true, "Let the body go after each load, and read it");
    add("--no-unload", forge.unload, false, "Do not, though a hidden effect needs it")->excludes(unload);
    verb->add_option("--dwell", forge.dwell, "Read each held load so long after it was put on, T1,T2,... [s]")
        ->delimiter(',')
        ->check(CLI::PositiveNumber)
        ->group("Probing");
    auto* continuous = add("--continuous", forge.continuous, true, "One body goes through all probes");
    add("--no-continuous", forge.continuous, false,
        "Each probe finds it as new, though a hidden effect needs the other")
        ->excludes(continuous);
}

void add_fault_flags(CLI::App* verb, ForgeOptions& forge) {
    verb->add_option("--hide", forge.hide,
                     "An effect that the set does not tell ('palpate effects' lists them), EFFECT[:name=value,...];\n"
                     "what is not told is drawn, strong enough to be seen. Repeatable; 'none' hides nothing")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(CLI::Validator([](std::string& wish) { return slip_in(wish); }, "EFFECT[:name=value,...]"))
        ->group("Truth");
    verb->add_option("--missing", forge.missing, "Share of the readings that are left out")
        ->check(CLI::Range(0.0, 0.9))
        ->group("Truth");
    verb->add_option("--unlabelled", forge.unlabelled, "Share of the readings that do not tell their marker")
        ->check(CLI::Range(0.0, 1.0))
        ->group("Truth");
    verb->add_flag("--tell-material", forge.tell_material, "Tell the material in the set, though something is hidden")
        ->group("Truth");
}

void add_solver_flags(CLI::App* verb, commands::ProbeCommandOptions& probe) {
    auto* from = verb->add_option("--from", probe.from,
                                  "Take the fields of another solver: a folder of .frd, .dat (CalculiX), .vtu or .vtp\n"
                                  "files, and a probes.csv or the .inp file with the loads");
    from->group("Another solver");
    verb->add_option("--array", probe.array,
                     "Point array of displacements in .vtu and .vtp files; by default the\n"
                     "one that is called so")
        ->needs(from)
        ->group("Another solver");
    auto* to = verb->add_option("--to", probe.to,
                                "Write what is to be computed, in place of computing it: body.inp for Abaqus or\n"
                                "CalculiX, a step for each state, and probes.csv");
    to->check(CLI::IsMember({"inp"}))->excludes(from)->group("Another solver");
    for (const char* own :
         {"--hide", "--law", "--linear", "--levels", "--unload", "--no-unload", "--dwell", "--continuous",
          "--no-continuous", "--probes", "--displacement", "--tell-material", "--edge-length", "--linear-elements"})
        from->excludes(verb->get_option(own));
    for (const char* own : {"--hide", "--noise", "--missing", "--unlabelled", "--dwell", "--unload", "--continuous"})
        to->excludes(verb->get_option(own));
}

}  // namespace

void Verbs::add_probe(CLI::App& app) {
    auto* sub = verb(app, "probe", "Reference deformations under probing forces, as a measurement set.",
                     "  palpate probe liver.stl -o set --noise 0.05\n"
                     "  palpate probe liver.stl -o riddle --hide gravity          # what is missing? truth.json tells\n"
                     "  palpate probe liver.stl -o riddle --hide inclusion:ratio=8,radius=12 --hide misalignment\n"
                     "  palpate probe finger.stl -o creep --hide viscosity --dwell 0.1,2,10 --unload\n"
                     "  palpate probe liver.stl -o null --hide none --seed 7      # a riddle without an answer\n"
                     "  palpate probe model.json -o twin        # the skeleton itself is the hidden truth\n"
                     "  palpate probe liver.stl --to inp -o deck    # for your own solver; then (cd deck && ccx body)\n"
                     "  palpate probe liver.stl --from deck -o set  # and what it computed\n",
                     [this] {
                         if (common.seed) probe.say.set("seed", static_cast<double>(*common.seed));
                         return commands::probe(probe, common);
                     });
    sub->add_option("INPUT", probe.input, "A mesh, a case.yaml, a measurement set, or a model.json")->required();
    sub->add_option("-o,--output", probe.output, "The set's folder; measurements by default");
    add_flags_of(sub, probe.say, "Body");
    add_law_flags(sub, probe.forge);
    add_flags_of(sub, probe.say, "Probing");
    add_sequence_flags(sub, probe.forge);
    add_fault_flags(sub, probe.forge);
    add_solver_flags(sub, probe);
}

}  // namespace palpate::pipeline
