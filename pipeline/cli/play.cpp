#include <fmt/format.h>

#include <cstdio>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/play/play_page.h"
#include "pipeline/play/serve.h"

// A model in the hand.

namespace palpate::pipeline::commands {
namespace {

nlohmann::json summary(const PlayData& data, const std::string& page) {
    return {{"models", data.models}, {"states", data.states}, {"bytes", page.size()}, {"notes", data.notes}};
}

/// Says where the page is, as soon as it is there, and stays until the end.
void serve_aloud(const PlayData& data, const std::string& page, int port, bool as_json) {
    serve(page, port, [&](int at) {
        const std::string address = fmt::format("http://127.0.0.1:{}/", at);
        nlohmann::json told = summary(data, page);
        told["address"] = address;
        fmt::print("{}\n", as_json ? told.dump(2) : address + "  (Ctrl-C ends it)");
        std::fflush(stdout);
    });
}

}  // namespace

Outcome play(const PlayOptions& options, const Common& common) {
    if (!options.output.empty()) {
        if (std::filesystem::is_directory(options.output))
            throw InvalidInput(options.output.string() + ": is a folder; name the page, as in -o page.html");
        refuse_to_overwrite(options.output, common.force);
    }
    const PlayData data = play_data(options.model, options.set);
    Console::notices(data.notes);
    const std::string page = play_page(data);
    constexpr std::size_t large = 5'000'000;
    if (page.size() > large) {
        Console::warning(
            fmt::format("The page has {:.1f} MB: browsers open it slowly. A skin of fewer triangles makes it smaller.",
                        static_cast<double>(page.size()) / 1e6));
    }
    if (options.output.empty()) {
        serve_aloud(data, page, options.port, common.json);
        return {};
    }
    mesh::write_text(options.output, page);
    Outcome outcome;
    outcome.text =
        fmt::format("Page: {}\nOpen it in a browser and pull; it needs no network.\n", options.output.string());
    outcome.json = summary(data, page);
    outcome.json["file"] = options.output.string();
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_play(CLI::App& app) {
    auto* sub = subcommand(
        app, "play", "Touch the calibrated model in a browser: drag it, feel its stiffness, switch its effects.",
        "  palpate play runs/organ                                 # serves it to this machine alone\n"
        "  palpate play runs/organ -o organ.html                   # one page that needs no network\n"
        "  palpate play model.json --set measurements -o page.html # with the measured markers\n",
        [this] { return commands::play(play, common); });
    sub->add_option("MODEL", play.model, "model.json, a folder of identify or improve, or a run folder")->required();
    auto* page = sub->add_option("-o,--output", play.output, "The page; without it, it is served at 127.0.0.1");
    sub->add_option("--set", play.set,
                    "Measurement set that is drawn and that the error is told of; by default that of the run");
    sub->add_option("--port", play.port, "Where it is served; a free port by default")
        ->check(CLI::Range(1, 65535))
        ->excludes(page);
}

}  // namespace palpate::pipeline
