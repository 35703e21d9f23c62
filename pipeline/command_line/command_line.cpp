#include "pipeline/command_line/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/terminal/usage_error.h"
#include "pipeline/command_line/version_text.h"

namespace palpate::pipeline {

struct CommandLine::Impl {
    Subcommands subcommands;
    bool quiet = false, verbose = false;

    void add_common(CLI::App& app);
};

namespace {

constexpr const char* description =
    "From a mesh to a calibrated real-time model of spheres and links.\n\n"
    "  palpate run liver.stl --longest 200      calibrate against finite elements\n"
    "  palpate run my-measurements/             calibrate against measurements, say what is missing\n"
    "  palpate check liver.stl                  what is wrong with this mesh?\n\n"
    "Units: mm, N, MPa, s. Exit codes: 0 done, 1 internal error, 2 wrong usage, 3 bad input, 4 numerical failure,\n"
    "5 tolerance not met.";

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

CLI::App* Subcommands::subcommand(CLI::App& app, const std::string& name, const std::string& what,
                                  const std::string& examples, const std::function<commands::Outcome()>& action) {
    CLI::App* sub = app.add_subcommand(name, what + "\n\nExamples:\n" + examples);
    sub->callback([this, action] { command = action; });
    sub->footer(
        "Everywhere:\n"
        "  --json                      The result as one JSON object on standard output\n"
        "  --threads INT               Threads; all cores by default. They change no number\n"
        "  --seed UINT                 Seed of everything random\n"
        "  --force                     Replace files that palpate did not make\n"
        "  -q,--quiet  -v,--verbose    Result and errors only; more detail\n");
    return sub;
}

void CommandLine::Impl::add_common(CLI::App& app) {
    app.add_flag("--json", subcommands.common.json, "The result as one JSON object on standard output");
    app.add_option("--threads", subcommands.common.threads, "Threads; all cores by default")
        ->check(CLI::Range(1, 1024));
    app.add_option("--seed", subcommands.common.seed, "Seed of everything random");
    app.add_flag("--force", subcommands.common.force, "Replace files that palpate did not make");
    auto* quiet_flag = app.add_flag("-q,--quiet", quiet, "Result and errors only");
    app.add_flag("-v,--verbose", verbose, "More detail")->excludes(quiet_flag);
    app.set_version_flag("--version", [this] { return version_text(subcommands.common.json); });
}

CommandLine::CommandLine() : impl_(std::make_unique<Impl>()) {
    impl_->subcommands.common.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}
CommandLine::~CommandLine() = default;

std::optional<commands::ExitCode> CommandLine::parse(int argc, char** argv) {
    CLI::App app(description, "palpate");
    app.require_subcommand(1);
    app.formatter(std::make_shared<OneLinePerCommand>());
    app.fallthrough();
    impl_->add_common(app);
    Subcommands& subcommands = impl_->subcommands;
    subcommands.add_run(app);
    subcommands.add_check(app);
    subcommands.add_import(app);
    subcommands.add_mesh(app);
    subcommands.add_skeleton(app);
    subcommands.add_probe(app);
    subcommands.add_identify(app);
    subcommands.add_compare(app);
    subcommands.add_diagnose(app);
    subcommands.add_improve(app);
    subcommands.add_effects(app);
    subcommands.add_simulate(app);
    subcommands.add_report(app);
    subcommands.add_pool(app);
    subcommands.add_new(app);
    subcommands.add_info(app);
    subcommands.add_completion(app);
    subcommands.add_man(app);
    subcommands.add_export(app);
    subcommands.add_play(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e), commands::done;
        fmt::print(stderr, "error: {}\n", usage_error(app, e, {argv + 1, argv + argc}));
        return commands::wrong_usage;
    }
    return std::nullopt;
}

const commands::Common& CommandLine::common() const { return impl_->subcommands.common; }
Verbosity CommandLine::verbosity() const {
    return impl_->quiet ? Verbosity::quiet : impl_->verbose ? Verbosity::verbose : Verbosity::normal;
}
std::function<commands::Outcome()> CommandLine::command() const { return impl_->subcommands.command; }

}  // namespace palpate::pipeline
