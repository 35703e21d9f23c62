#include "pipeline/run/summary.h"

#include <fmt/format.h>

#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/damping.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/comparison/worst.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/text/words.h"
#include "pipeline/run/inputs/model_and_set.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// The command that follows from a verdict.
std::string next_command(const Subject& subject, const RunResults& results, const fs::path& run) {
    if (!subject.set)
        return fmt::format("palpate run {} -o {} --probes 200", subject.settings.mesh->string(), run.string());
    const std::string set = subject.set->folder.lexically_normal().string();
    if (results.diagnosis.is_null()) {
        return fmt::format("palpate compare {} {}", (run / "identify/model.json").string(), set);
    }
    const std::string verdict = results.diagnosis["verdict"], left = results.ladder["verdict"];
    if (verdict == "ambiguous") {
        return fmt::format("palpate run {} -o {}    # once the next probe is in the set", set, run.string());
    }
    const std::string model = (run / "improve/model.json").string();
    if (verdict == "unexplained") return "palpate effects    # what the catalogue holds";
    if (left != "adequate") return fmt::format("palpate diagnose {} {}", model, set);
    return command_to_play(model, *subject.set);
}

/// What was found: of a model that something was added to, the one that came of it is what is described.
std::string findings(const RunResults& results) {
    std::string text;
    if (results.improved.is_null()) text = compare_in_words(results.compare) + "\n" + worst_table(results.compare);
    if (!results.diagnosis.is_null()) text += diagnosis_in_words(results.diagnosis) + "\n";
    if (!results.ladder.is_null()) text += ladder_in_words(results.ladder);
    if (!results.improved.is_null()) {
        const auto added = results.ladder["steps"].back()["effects"].get<std::vector<std::string>>();
        text += compare_in_words(results.improved,
                                 fmt::format("The real-time model with {}, fitted to all probes,", listed(added))) +
                "\n" + worst_table(results.improved);
    }
    return text;
}

std::string summary(const Subject& subject, const RunResults& results, const fs::path& run) {
    std::string text = fmt::format("{}: {} spheres, {} links.\n{}", subject.settings.name, results.spheres,
                                   results.links, findings(results));
    if (!results.damping.is_null()) text += damping_in_words(results.damping);
    return text + fmt::format("\nReport: {}\nParaView: paraview --script={}\nNext: {}\n",
                              (run / "report.html").string(), (run / "view.py").string(),
                              next_command(subject, results, run));
}

}  // namespace

Outcome outcome_of(const Subject& subject, const RunResults& results, const RunFolder& folder) {
    Outcome outcome;
    outcome.text = summary(subject, results, folder.path());
    outcome.json = {{"run", folder.path().string()}, {"report", (folder.path() / "report.html").string()},
                    {"spheres", results.spheres},    {"links", results.links},
                    {"compare", results.compare},    {"diagnosis", results.diagnosis},
                    {"ladder", results.ladder},      {"stages", folder.record()["stages"]}};
    const std::vector<std::string> broken = broken_expectations(subject.settings.expect, results);
    for (const std::string& line : broken) Console::error("expectation not met: " + line);
    outcome.json["expectations_not_met"] = broken;
    outcome.code = broken.empty() ? done : not_met;
    return outcome;
}

}  // namespace palpate::pipeline::commands
