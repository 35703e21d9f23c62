#include <fmt/format.h>

#include <cstdio>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "pipeline/commands/common.h"
#include "pipeline/console.h"
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
