#include <fmt/format.h>

#include <cstdio>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/play/pick/pick_page.h"
#include "pipeline/play/play_page.h"
#include "pipeline/play/serve.h"

// An interactive page of a model, or of a body that is set up by mouse.

namespace palpate::pipeline::commands {
namespace {

/// Says where the page is, as soon as it is there, and stays until the end.
void serve_aloud(nlohmann::json told, const std::string& page, int port, bool as_json) {
    serve(page, port, [&](int at) {
        const std::string address = fmt::format("http://127.0.0.1:{}/", at);
        told["address"] = address;
        fmt::print("{}\n", as_json ? told.dump(2) : address + "  (Ctrl-C ends it)");
        std::fflush(stdout);
    });
}

/// Writes a page, or serves it. `next`: what to do with it, in words.
Outcome hand_out(const std::string& page, nlohmann::json told, const std::string& next, const PlayOptions& options,
                 const Common& common) {
    constexpr std::size_t large = 5'000'000;  // bytes: a choice; the warning hinders nothing
    if (page.size() > large) {
        Console::warning(
            fmt::format("The page has {:.1f} MB: browsers open it slowly. A skin of fewer triangles makes it smaller.",
                        static_cast<double>(page.size()) / 1e6));
    }
    told["bytes"] = page.size();
    if (options.output.empty()) {
        serve_aloud(std::move(told), page, options.port, common.json);
        return {};
    }
    mesh::write_text(options.output, page);
    told["file"] = options.output.string();
    Outcome outcome;
    outcome.text = fmt::format("Page: {}\n{}\n", options.output.string(), next);
    outcome.json = std::move(told);
    return outcome;
}

Outcome play_models(const PlayOptions& options, const Common& common) {
    const PlayData data = play_data(options.input, options.set);
    Console::notices(data.notes);
    return hand_out(play_page(data), {{"models", data.models}, {"states", data.states}, {"notes", data.notes}},
                    "Open it in a browser and pull; it needs no network.", options, common);
}

Outcome set_up(const PlayOptions& options, const Common& common) {
    const Subject subject = read_subject(read_case(options.input, options.overrides));
    Console::notices(subject.notes);
    return hand_out(pick_page(subject), {{"triangles", subject.surface.triangles.rows()}, {"notes", subject.notes}},
                    "Open it in a browser, click on the body, and download the files; it needs no network.", options,
                    common);
}

}  // namespace

Outcome play(const PlayOptions& options, const Common& common) {
    if (!options.output.empty()) {
        if (std::filesystem::is_directory(options.output))
            throw InvalidInput(options.output.string() + ": is a folder; name the page, as in -o page.html");
        refuse_to_overwrite(options.output, common.force);
    }
    return options.pick ? set_up(options, common) : play_models(options, common);
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_play(CLI::App& app) {
    auto* sub = subcommand(
        app, "play",
        "Touch the calibrated model in a browser: drag it, feel its stiffness, switch its effects. Or set up a body: "
        "choose by mouse where it is held, pressed and read.",
        "  palpate play runs/organ                                 # serves it to this machine alone\n"
        "  palpate play runs/organ -o organ.html                   # one page that needs no network\n"
        "  palpate play model.json --set measurements -o page.html # with the measured markers\n"
        "  palpate play liver.stl --pick                           # supports, probes and markers by mouse\n",
        [this] { return commands::play(play, common); });
    sub->add_option("INPUT", play.input,
                    "model.json, a folder of identify or improve, or a run folder; with --pick a mesh, a case.yaml or "
                    "a measurement set")
        ->required();
    auto* page = sub->add_option("-o,--output", play.output, "The page; without it, it is served at 127.0.0.1");
    auto* set = sub->add_option("--set", play.set,
                                "Measurement set that is drawn and that errors refer to; by default that of the run")
                    ->type_name("PATH");
    auto* pick = sub->add_flag(
        "--pick", play.pick,
        "Choose on the body where it is held, pressed and read; the page hands out case.yaml and a measurement set to "
        "fill in");
    pick->excludes(set);
    sub->add_option("--port", play.port, "Where it is served; a free port by default")
        ->check(CLI::Range(1, 65535))
        ->excludes(page);
    add_flags_of(sub, play.overrides, "Body");
    for (CLI::Option* option : sub->get_options([](const CLI::Option* one) { return one->get_group() == "Body"; }))
        option->needs(pick);
}

}  // namespace palpate::pipeline
