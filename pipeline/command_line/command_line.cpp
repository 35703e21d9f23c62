#include "pipeline/command_line/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <sstream>
#include <thread>

#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/tree/tree.h"
#include "pipeline/command_line/tree/usage_error.h"
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

/// Help in our words in place of CLI11's types and notes on which options need and exclude each other.
class HelpFormatter : public CLI::Formatter {
public:
    /// In the list of commands, a line each: examples stand in a command's own help.
    std::string make_subcommand(const CLI::App* sub) const override {
        const std::string text = sub->get_description();
        std::stringstream out;
        CLI::detail::format_help(out, sub->get_display_name(), text.substr(0, text.find('\n')), 16);
        return out.str();
    }

    /// Options of which one is needed.
    std::string make_expanded(const CLI::App* sub) const override {
        if (!sub->get_name().empty()) return CLI::Formatter::make_expanded(sub);
        return make_group(sub->get_group() + ", " + sub->get_description(), false,
                          sub->get_options([&](const CLI::Option* one) { return one != sub->get_help_ptr(); }));
    }

    std::string make_option_opts(const CLI::Option* option) const override {
        if (option->get_positional() || option->get_expected_max() == 0) return {};
        std::string value = " " + option_value(*option).word;
        if (option->get_delimiter() != '\0') {
            value += fmt::format("{}...", option->get_delimiter());
        } else if (option->get_expected_max() == CLI::detail::expected_max_vector_size) {
            value += " ...";
        }
        return value + (option->get_required() ? " (required)" : "");
    }

    std::string make_option_desc(const CLI::Option* option) const override {
        constexpr double large = 1e5;  // bounds beyond are of memory and patience
        std::string text = option->get_description();
        const OptionValue value = option_value(*option);
        if (value.least && value.most && *value.most <= large)
            text += fmt::format(" ({:g} to {:g})", *value.least, *value.most);
        if (!option->get_default_str().empty()) text += fmt::format("; {} by default", option->get_default_str());
        for (const CLI::Option* needed : option->get_needs()) text += fmt::format(" (with {})", needed->get_name());
        return text;
    }

    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
        std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
        for (std::size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
        return text;
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
        "  --threads N                 Threads; all cores by default. They change no number\n"
        "  --seed N                    Seed of everything random\n"
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
    app.formatter(std::make_shared<HelpFormatter>());
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
