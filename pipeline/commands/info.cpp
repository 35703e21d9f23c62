#include <fmt/format.h>

#include "pipeline/commands/common.h"
#include "pipeline/info/describe.h"

namespace palpate::pipeline::commands {

Outcome info(const InfoOptions& options, const Common&) {
    const Description told = describe(options.file);
    Outcome outcome;
    outcome.text = fmt::format("{}: {}\n", options.file.string(), told.kind);
    for (const std::string& line : told.lines) outcome.text += line + "\n";
    if (!told.next.empty()) outcome.text += "Next: " + told.next + "\n";
    outcome.json = {{"file", options.file.string()}, {"kind", told.kind}, {"lines", told.lines}, {"next", told.next}};
    return outcome;
}

}  // namespace palpate::pipeline::commands
