#include "pipeline/command_line.h"

#include <CLI/CLI.hpp>
#include <thread>

#include "pipeline/version.h"

namespace palpate::pipeline {

using commands::Outcome;

struct CommandLine::Impl {
    commands::Common common;
    bool quiet = false, verbose = false;
    std::function<Outcome()> command;

    commands::RunOptions run;
    commands::CheckOptions check;
    commands::MeshOptions mesh;
    commands::SkeletonOptions skeleton;
    commands::ProbeCommandOptions probe;
    commands::IdentifyCommandOptions identify;
    commands::CompareOptions compare;
    commands::SimulateOptions simulate;
    commands::ReportOptions report;

    void add_common(CLI::App& app);
    void add_run(CLI::App& app);
    void add_check(CLI::App& app);
    void add_mesh(CLI::App& app);
    void add_skeleton(CLI::App& app);
    void add_probe(CLI::App& app);
    void add_identify(CLI::App& app);
    void add_compare(CLI::App& app);
    void add_simulate(CLI::App& app);
    void add_report(CLI::App& app);

    /// A verb whose help begins with examples.
    CLI::App* verb(CLI::App& app, const std::string& name, const std::string& what, const std::string& examples,
                   const std::function<Outcome()>& action);
};

namespace {

constexpr const char* description =
    "From a mesh to a calibrated real-time model of spheres and links.\n\n"
    "  palpate run liver.stl --longest 200      calibrate against finite elements\n"
    "  palpate run my-measurements/             calibrate against measurements\n"
    "  palpate check liver.stl                  what is wrong with this mesh?\n\n"
    "Units: mm, N, MPa, s. Exit codes: 0 done, 1 internal error, 2 wrong usage, 3 bad input, 4 numerical failure,\n"
    "5 tolerance not met.";

void add_body_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--unit", say.unit, "Unit of the mesh")->check(CLI::IsMember({"mm", "cm", "m"}))->group("Body");
    verb->add_option("--longest", say.longest, "Scale the mesh to this longest side [mm]")
        ->check(CLI::PositiveNumber)
        ->group("Body");
    verb->add_option("--young", say.young, "Young's modulus [MPa]")->check(CLI::PositiveNumber)->group("Body");
    verb->add_option("--poisson", say.poisson, "Poisson's ratio")->check(CLI::Range(-0.99, 0.4999))->group("Body");
    verb->add_option("--density", say.density, "Density [kg/m^3]")->check(CLI::NonNegativeNumber)->group("Body");
    verb->add_option("--edge-length", say.edge_length, "Of the tetrahedra [mm]; 6 % of the longest side by default")
        ->check(CLI::PositiveNumber)
        ->group("Body");
    verb->add_flag("--linear-elements", say.linear_elements, "Four-node tetrahedra in place of quadratic ones")
        ->group("Body");
}

void add_skeleton_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--spheres", say.spheres, "Number of free spheres; by the body's shape by default")
        ->check(CLI::Range(1, 100000))
        ->group("Skeleton");
    verb->add_option("--coverage", say.coverage, "No surface further outside the spheres than this [mm]")
        ->check(CLI::PositiveNumber)
        ->group("Skeleton");
    verb->add_option("--zones", say.zones, "Zones of equal stiffness, from the support outwards")
        ->check(CLI::Range(1, 1000))
        ->group("Skeleton");
}

void add_identify_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--parameters", say.parameters, "What is identified: uniform, zones, links")
        ->check(CLI::IsMember({"uniform", "zones", "links"}))
        ->group("Identification");
    verb->add_option("--method", say.method,
                     "tempered: particles tempered from a Laplace proposal; burion2008: Algorithm 1")
        ->check(CLI::IsMember({"tempered", "burion2008"}))
        ->group("Identification");
    verb->add_option("--particles", say.particles, "Number of particles")
        ->check(CLI::Range(2, 10'000'000))
        ->group("Identification");
}

void add_probing_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--probes", say.probes, "Number of loaded states")->check(CLI::Range(1, 10000))->group("Probing");
    verb->add_option("--noise", say.noise, "1 sigma of the readings [mm]")
        ->check(CLI::NonNegativeNumber)
        ->group("Probing");
}

/// In the list of commands, a line each: examples stand in a command's own help.
class OneLinePerCommand : public CLI::Formatter {
public:
    std::string make_subcommand(const CLI::App* sub) const override {
        const std::string text = sub->get_description();
        std::stringstream out;
        CLI::detail::format_help(out, sub->get_display_name(), text.substr(0, text.find('\n')), 16);
        return out.str();
    }
};

}  // namespace

CLI::App* CommandLine::Impl::verb(CLI::App& app, const std::string& name, const std::string& what,
                                  const std::string& examples, const std::function<Outcome()>& action) {
    CLI::App* sub = app.add_subcommand(name, what + "\n\nExamples:\n" + examples);
    sub->callback([this, action] { command = action; });
    return sub;
}

void CommandLine::Impl::add_common(CLI::App& app) {
    app.add_flag("--json", common.json, "The result as one JSON object on standard output");
    app.add_option("--threads", common.threads, "Threads; all cores by default")->check(CLI::Range(1, 1024));
    app.add_option("--seed", common.seed, "Seed of everything random");
    app.add_flag("--force", common.force, "Replace files that palpate did not make");
    auto* quiet_flag = app.add_flag("-q,--quiet", quiet, "Errors only");
    app.add_flag("-v,--verbose", verbose, "More detail")->excludes(quiet_flag);
    app.set_version_flag("--version", std::string("palpate ") + version);
}

void CommandLine::Impl::add_run(CLI::App& app) {
    auto* sub = verb(app, "run", "The whole pipeline: mesh, skeleton, reference, identification, comparison, report.",
                     "  palpate run liver.stl --longest 200\n"
                     "  palpate run my-measurements/ -o result\n"
                     "  palpate run case.yaml\n",
                     [this] {
                         if (run.output.empty()) {
                             run.output = std::filesystem::path(
                                 std::filesystem::weakly_canonical(run.input).stem().string() + "-run");
                         }
                         run.say.seed = common.seed;
                         return commands::run(run, common);
                     });
    sub->add_option("INPUT", run.input, "A case.yaml, a measurement set (folder or set.yaml), or a mesh")->required();
    sub->add_option("-o,--output", run.output, "The run folder; <input>-run by default");
    add_body_flags(sub, run.say);
    add_skeleton_flags(sub, run.say);
    add_probing_flags(sub, run.say);
    add_identify_flags(sub, run.say);
}

void CommandLine::Impl::add_check(CLI::App& app) {
    auto* sub = verb(app, "check", "Reads everything, repairs nothing, says what is wrong.",
                     "  palpate check liver.stl\n  palpate check my-measurements/ --json\n",
                     [this] { return commands::check(check, common); });
    sub->add_option("INPUT", check.input, "A case.yaml, a measurement set, or a mesh")->required();
    add_body_flags(sub, check.say);
}

void CommandLine::Impl::add_mesh(CLI::App& app) {
    auto* sub = verb(app, "mesh", "Repairs, remeshes and fills a surface with tetrahedra.",
                     "  palpate mesh liver.stl -o body.vtu --edge-length 8\n",
                     [this] { return commands::mesh_body(mesh, common); });
    sub->add_option("SURFACE", mesh.input, "STL, OBJ, PLY, OFF or VTP")->required();
    sub->add_option("-o,--output", mesh.output, "The volume mesh; body.vtu by default");
    add_body_flags(sub, mesh.say);
}

void CommandLine::Impl::add_skeleton(CLI::App& app) {
    auto* sub = verb(app, "skeleton", "Medial axis, spheres, links and skin, with start stiffness from the sections.",
                     "  palpate skeleton liver.stl -o model.json\n  palpate skeleton finger.stl --spheres 12\n",
                     [this] { return commands::skeleton(skeleton, common); });
    sub->add_option("INPUT", skeleton.input, "A mesh, a case.yaml, or a measurement set")->required();
    sub->add_option("-o,--output", skeleton.output, "The model; model.json by default");
    add_body_flags(sub, skeleton.say);
    add_skeleton_flags(sub, skeleton.say);
}

void CommandLine::Impl::add_probe(CLI::App& app) {
    auto* sub = verb(app, "probe", "Reference deformations under probing forces, as a measurement set.",
                     "  palpate probe liver.stl -o set --noise 0.05\n"
                     "  palpate probe model.json -o twin        # the skeleton itself is the hidden truth\n",
                     [this] {
                         probe.say.seed = common.seed;
                         return commands::probe(probe, common);
                     });
    sub->add_option("INPUT", probe.input, "A mesh, a case.yaml, a measurement set, or a model.json")->required();
    sub->add_option("-o,--output", probe.output, "The set's folder; measurements by default");
    add_body_flags(sub, probe.say);
    add_probing_flags(sub, probe.say);
}

void CommandLine::Impl::add_identify(CLI::App& app) {
    auto* sub = verb(app, "identify", "Stiffness per link by particle filter.",
                     "  palpate identify model.json set/ -o fitted --parameters zones\n",
                     [this] { return commands::identify(identify, common); });
    sub->add_option("MODEL", identify.model, "model.json")->required();
    sub->add_option("SET", identify.set, "The measurements")->required();
    sub->add_option("-o,--output", identify.output,
                    "Folder for model.json, posterior.csv, history.pvd; identified by default");
    add_identify_flags(sub, identify.say);
    sub->add_option("--law", identify.law, "Law of equilibrium; by fit by default")
        ->check(CLI::IsMember({"automatic", "linear", "large-rotation"}))
        ->group("Identification");
    sub->add_option("--search-low", identify.search_low, "burion2008: lower end of the box, in start stiffnesses")
        ->group("Identification");
    sub->add_option("--search-high", identify.search_high, "burion2008: upper end of the box")->group("Identification");
}

void CommandLine::Impl::add_compare(CLI::App& app) {
    auto* sub = verb(
        app, "compare", "Model against measurements: how wrong, where, under which probe.",
        "  palpate compare model.json set/\n  palpate compare model.json set/ --tolerance 0.5 && echo good enough\n",
        [this] { return commands::compare(compare, common); });
    sub->add_option("MODEL", compare.model, "model.json")->required();
    sub->add_option("SET", compare.set, "The measurements")->required();
    sub->add_option("-o,--output", compare.output, "Folder for compare.json and the .vtp series");
    sub->add_option("--tolerance", compare.tolerance, "Exit code 5 where the rms error is larger [mm]")
        ->check(CLI::NonNegativeNumber);
}

void CommandLine::Impl::add_simulate(CLI::App& app) {
    auto* sub = verb(app, "simulate", "Plays the model: equilibria under given contacts.",
                     "  palpate simulate model.json --probes set/probes.csv -o played\n",
                     [this] { return commands::simulate(simulate, common); });
    sub->add_option("MODEL", simulate.model, "model.json")->required();
    sub->add_option("--probes", simulate.probes, "probes.csv: probe,time,x,y,z,fx,fy,fz,radius [mm, N]")->required();
    sub->add_option("-o,--output", simulate.output, "Folder for simulation.pvd; simulation by default");
}

void CommandLine::Impl::add_report(CLI::App& app) {
    auto* sub = verb(app, "report", "A run as one self-contained page.", "  palpate report liver-run -o report.html\n",
                     [this] { return commands::report(report, common); });
    sub->add_option("RUN", report.run, "The run folder")->required();
    sub->add_option("-o,--output", report.output, "The page; report.html in the run folder by default");
}

CommandLine::CommandLine() : impl_(std::make_unique<Impl>()) {
    impl_->common.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}
CommandLine::~CommandLine() = default;

std::optional<commands::ExitCode> CommandLine::parse(int argc, char** argv) {
    CLI::App app(description, "palpate");
    app.require_subcommand(1);
    app.formatter(std::make_shared<OneLinePerCommand>());
    app.fallthrough();
    impl_->add_common(app);
    impl_->add_run(app);
    impl_->add_check(app);
    impl_->add_mesh(app);
    impl_->add_skeleton(app);
    impl_->add_probe(app);
    impl_->add_identify(app);
    impl_->add_compare(app);
    impl_->add_simulate(app);
    impl_->add_report(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? commands::done : commands::wrong_usage;
    }
    return std::nullopt;
}

const commands::Common& CommandLine::common() const { return impl_->common; }
Verbosity CommandLine::verbosity() const {
    return impl_->quiet ? Verbosity::quiet : impl_->verbose ? Verbosity::verbose : Verbosity::normal;
}
std::function<Outcome()> CommandLine::command() const { return impl_->command; }

}  // namespace palpate::pipeline
