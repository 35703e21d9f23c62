#include "pipeline/run/summary.h"

#include <fmt/format.h>

#include "pipeline/output/damping.h"
#include "pipeline/output/ladder.h"
#include "pipeline/output/text/comparison.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/text/words.h"
#include "pipeline/output/text/worst.h"
#include "pipeline/run/model_and_set.h"

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
        text +=
            compare_in_words(results.improved, fmt::format("The model with {}, fitted to all probes,", listed(added))) +
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

void report_stage(const RunFolder& folder, const std::string& stage, bool ran, const std::string& what) {
    const nlohmann::json& record = folder.record()["stages"][stage];
    Console::notice(fmt::format("{:<12} {} ({})", stage, what,
                                ran ? fmt::format("{:.1f} s, {:.0f} MB", record["seconds"].get<double>(),
                                                  record["peak_memory_mb"].get<double>())
                                    : "unchanged"));
}

}  // namespace palpate::pipeline::commands
